#include "baker/store/traced_rows.h"

#include <algorithm>

#include "baker/core/parallel.h"
#include "baker/store/ray_sum.h"

namespace luxel {
namespace {

/// Rows that are traced and packed together: few enough for a thread's memory, many enough to pack well.
constexpr std::uint32_t run_rows = 128;
const std::string where_from = "rays traced again";

/// What one patch met: other patches, ascending, with their counts.
struct Row {
    std::vector<PatchNumber> targets;
    std::vector<std::uint32_t> counts;
};

/// Tallies of one patch go to place `at`.
Row count_landings(PatchNumber patch, const std::vector<Landings>& all, StripTallies& tallies, std::size_t at) {
    std::vector<std::uint64_t> met;  // target in the high half, weight in the low one
    for (const Landings& landings : all) {
        add_rays(tallies.rays[at], std::uint64_t{landings.open} + landings.back, where_from);
        tallies.open[at] += landings.open;
        tallies.back[at] += landings.back;
        for (std::size_t k = 0; k < landings.patches.size(); ++k)
            met.push_back((std::uint64_t{landings.patches[k]} << 32) | (landings.weights.empty() ? 1 : landings.weights[k]));
    }
    std::sort(met.begin(), met.end());
    Row row;
    for (std::size_t k = 0; k < met.size();) {
        const auto target = static_cast<PatchNumber>(met[k] >> 32);
        std::uint32_t count = 0;
        for (; k < met.size() && (met[k] >> 32) == target; ++k) add_rays(count, met[k] & 0xffffffffu, where_from);
        add_rays(tallies.rays[at], count, where_from);
        if (target == patch) {
            tallies.self[at] = count;
        } else {
            row.targets.push_back(target);
            row.counts.push_back(count);
        }
    }
    return row;
}

/// Rows cut by the chunks that they met, each part packed.
std::vector<TracedChunk::Segment> cut(const std::vector<Row>& rows, const ChunkLayout& layout) {
    std::vector<ChunkNumber> chunks;
    for (const Row& row : rows)
        for (std::size_t k = 0; k < row.targets.size();) {
            chunks.push_back(layout.chunk_of(row.targets[k]));
            const PatchNumber end = layout.first_patch[chunks.back() + 1];
            while (k < row.targets.size() && row.targets[k] < end) ++k;
        }
    std::sort(chunks.begin(), chunks.end());
    chunks.erase(std::unique(chunks.begin(), chunks.end()), chunks.end());
    std::vector<TracedChunk::Segment> segments;
    std::vector<std::size_t> next(rows.size());
    for (const ChunkNumber chunk : chunks) {
        const PatchNumber first = layout.first_patch[chunk], end = layout.first_patch[chunk + 1];
        StripPairs pairs{static_cast<std::uint32_t>(rows.size()), end - first, {0}, {}, {}};
        for (std::size_t r = 0; r < rows.size(); ++r) {
            for (; next[r] < rows[r].targets.size() && rows[r].targets[next[r]] < end; ++next[r]) {
                pairs.column.push_back(static_cast<std::uint16_t>(rows[r].targets[next[r]] - first));
                pairs.count.push_back(rows[r].counts[next[r]]);
            }
            pairs.row_begin.push_back(static_cast<std::uint32_t>(pairs.column.size()));
        }
        segments.push_back({chunk, pack_pairs(pairs, false)});
    }
    return segments;
}

StripPairs transposed(const StripPairs& pairs) {
    StripPairs out{pairs.columns, pairs.rows, std::vector<std::uint32_t>(pairs.columns + 1), {}, {}};
    for (const std::uint16_t column : pairs.column) ++out.row_begin[column + 1u];
    for (std::uint32_t row = 0; row < out.rows; ++row) out.row_begin[row + 1] += out.row_begin[row];
    out.column.resize(pairs.column.size());
    out.count.resize(pairs.count.size());
    std::vector<std::uint32_t> next(out.row_begin.begin(), out.row_begin.end() - 1);
    for (std::uint32_t row = 0; row < pairs.rows; ++row)
        for (std::uint32_t k = pairs.row_begin[row]; k < pairs.row_begin[row + 1]; ++k) {
            const std::uint32_t at = next[pairs.column[k]]++;
            out.column[at] = static_cast<std::uint16_t>(row);
            out.count[at] = pairs.count[k];
        }
    return out;
}

/// The pairs above the diagonal (column > row), or those below it.
StripPairs half(const StripPairs& pairs, bool above) {
    StripPairs out{pairs.rows, pairs.columns, {0}, {}, {}};
    for (std::uint32_t row = 0; row < pairs.rows; ++row) {
        for (std::uint32_t k = pairs.row_begin[row]; k < pairs.row_begin[row + 1]; ++k)
            if ((pairs.column[k] > row) == above) {
                out.column.push_back(pairs.column[k]);
                out.count.push_back(pairs.count[k]);
            }
        out.row_begin.push_back(static_cast<std::uint32_t>(out.column.size()));
    }
    return out;
}

StripPairs sum(const StripPairs& x, const StripPairs& y) {
    StripPairs out{x.rows, x.columns, {0}, {}, {}};
    const auto add = [&](std::uint16_t column, std::uint32_t count) {
        out.column.push_back(column);
        out.count.push_back(count);
    };
    for (std::uint32_t row = 0; row < x.rows; ++row) {
        std::uint32_t i = x.row_begin[row], j = y.row_begin[row];
        while (i < x.row_begin[row + 1] || j < y.row_begin[row + 1]) {
            if (j == y.row_begin[row + 1] || (i < x.row_begin[row + 1] && x.column[i] < y.column[j])) {
                add(x.column[i], x.count[i]), ++i;
            } else if (i == x.row_begin[row + 1] || y.column[j] < x.column[i]) {
                add(y.column[j], y.count[j]), ++j;
            } else {
                std::uint32_t both = x.count[i];
                add_rays(both, y.count[j], where_from);
                add(x.column[i], both), ++i, ++j;
            }
        }
        out.row_begin.push_back(static_cast<std::uint32_t>(out.column.size()));
    }
    return out;
}

}  // namespace

/// A chunk being traced, run by run, by everybody who has time.
struct TracedRows::Job {
    Job(const TracedRows& owner, ChunkNumber c)
        : rows(owner), chunk(c), first(owner.layout_.first_patch[c]), size(owner.layout_.size(c)), out(std::make_shared<TracedChunk>()) {
        StripTallies& t = out->tallies;
        for (auto* column : {&t.rays, &t.self, &t.open, &t.back}) column->resize(size);
        out->runs.resize((size + run_rows - 1) / run_rows);
    }

    /// Takes runs until none is left. Returns when the others' are not yet done.
    void help() {
        flush_denormals();
        for (;;) {
            const std::size_t k = next++;
            if (k >= out->runs.size()) return;
            std::exception_ptr failed;
            try {
                trace_run(k);
            } catch (...) {
                failed = std::current_exception();
            }
            const std::lock_guard lock(mutex);
            if (failed && !error) error = failed;
            if (++done == out->runs.size()) all_done.notify_all();
        }
    }

    void wait() {
        std::unique_lock lock(mutex);
        all_done.wait(lock, [&] { return done == out->runs.size(); });
    }

    void trace_run(std::size_t k) {
        TracedChunk::Run& run = out->runs[k];
        run.first_row = static_cast<std::uint32_t>(k) * run_rows;
        run.rows = std::min(run_rows, size - run.first_row);
        std::vector<Row> found(run.rows);
        std::vector<Landings> landings;
        for (std::uint32_t r = 0; r < run.rows; ++r) {
            const PatchNumber patch = first + run.first_row + r;
            if (rows.levels_.levels[patch].empty()) continue;
            rows.estimator_.cast(patch, rows.levels_.levels[patch], landings);
            found[r] = count_landings(patch, landings, out->tallies, run.first_row + r);
        }
        run.segments = cut(found, rows.layout_);
    }

    const TracedRows& rows;
    ChunkNumber chunk;
    PatchNumber first;
    std::uint32_t size;
    std::shared_ptr<TracedChunk> out;
    std::atomic<std::size_t> next{0};
    std::mutex mutex;
    std::condition_variable all_done;
    std::size_t done = 0;
    std::exception_ptr error;
};

TracedRows::TracedRows(const Estimator& estimator, const ChunkLayout& layout, LevelPlan levels, std::uint64_t limit_bytes)
    : estimator_(estimator), layout_(layout), levels_(std::move(levels)), limit_bytes_(limit_bytes), slots_(layout.chunk_count()) {
    if (levels_.levels.size() != layout.patch_count())
        throw Error(ErrorCode::internal, "traced rows", "levels need one entry per patch");
}

std::uint64_t TracedRows::rays_of_all() const { return planned_rays(levels_, estimator_, 0, layout_.patch_count()); }

std::uint64_t TracedRows::rays_of(ChunkNumber c) const {
    return planned_rays(levels_, estimator_, layout_.first_patch[c], layout_.first_patch[c + 1]);
}

std::uint64_t TracedRows::held_bytes() const {
    const std::lock_guard lock(mutex_);
    return held_bytes_;
}

void TracedRows::forget() {
    const std::lock_guard lock(mutex_);
    for (Slot& slot : slots_) slot.rows.reset();
    held_bytes_ = 0;
}

std::shared_ptr<const TracedChunk> TracedRows::chunk(ChunkNumber c) {
    std::unique_lock lock(mutex_);
    for (;;) {
        Slot& slot = slots_.at(c);
        slot.used = ++time_;
        if (slot.rows) return slot.rows;
        if (!job_) return trace(c, lock);
        const std::shared_ptr<Job> running = job_;
        lock.unlock();
        running->help();
        lock.lock();
        finished_.wait(lock, [&] { return job_ != running; });
        // A chunk too large to be kept is still there for those who waited for it.
        if (running->chunk == c && !running->error) return running->out;
    }
}

std::shared_ptr<const TracedChunk> TracedRows::trace(ChunkNumber c, std::unique_lock<std::mutex>& lock) {
    const auto job = job_ = std::make_shared<Job>(*this, c);
    lock.unlock();
    // Idle threads come through the loop, those that want rows through chunk().
    parallel_isolated(job->out->runs.size(), [&](std::size_t) { job->help(); });
    job->wait();
    TracedChunk& rows = *job->out;
    rows.bytes = sizeof rows + layout_.size(c) * 4 * sizeof(std::uint32_t) + rows.runs.size() * sizeof(TracedChunk::Run);
    for (const TracedChunk::Run& run : rows.runs)
        for (const TracedChunk::Segment& segment : run.segments) rows.bytes += sizeof segment + segment.pairs.stored.capacity();
    rays_traced_ += rays_of(c);
    lock.lock();
    job_.reset();
    finished_.notify_all();
    if (job->error) std::rethrow_exception(job->error);
    keep(c, job->out);
    return job->out;
}

void TracedRows::keep(ChunkNumber c, std::shared_ptr<const TracedChunk> rows) {
    if (rows->bytes > limit_bytes_) return;
    while (held_bytes_ + rows->bytes > limit_bytes_) {
        Slot* last = nullptr;
        for (Slot& slot : slots_)
            if (slot.rows && slot.rows.use_count() == 1 && (!last || slot.used > last->used)) last = &slot;
        if (!last) return;  // all are in use
        held_bytes_ -= last->rows->bytes;
        last->rows.reset();
    }
    held_bytes_ += rows->bytes;
    slots_[c].rows = std::move(rows);
}

StripPairs rays_between(const TracedChunk& rows, const ChunkLayout& layout, ChunkNumber from, ChunkNumber to) {
    StripPairs all{layout.size(from), layout.size(to), {0}, {}, {}};
    for (const TracedChunk::Run& run : rows.runs) {
        const auto segment = std::lower_bound(run.segments.begin(), run.segments.end(), to,
                                              [](const TracedChunk::Segment& s, ChunkNumber chunk) { return s.target < chunk; });
        const auto before = static_cast<std::uint32_t>(all.column.size());
        if (segment == run.segments.end() || segment->target != to) {
            all.row_begin.insert(all.row_begin.end(), run.rows, before);
            continue;
        }
        const StripPairs part = unpack_pairs(BlockFileWriter::unpack(segment->pairs, where_from), false, where_from);
        for (std::uint32_t row = 0; row < part.rows; ++row) all.row_begin.push_back(before + part.row_begin[row + 1]);
        all.column.insert(all.column.end(), part.column.begin(), part.column.end());
        all.count.insert(all.count.end(), part.count.begin(), part.count.end());
    }
    return all;
}

StripPairs pooled_block(const TracedChunk& rows_a, const TracedChunk& rows_b, const ChunkLayout& layout, ChunkNumber a,
                        ChunkNumber b) {
    const StripPairs seen = rays_between(rows_a, layout, a, b);
    if (a == b) return sum(half(seen, true), transposed(half(seen, false)));
    return sum(seen, transposed(rays_between(rows_b, layout, b, a)));
}

}  // namespace luxel
