#include "baker/store/traced_rows.h"

#include <algorithm>
#include <exception>

#include "baker/core/parallel.h"

namespace luxel {
namespace {

/// Chunks that stay whole while there is room: the one whose row is read, and one per block in work on a small machine.
constexpr std::size_t most_whole = 4;

}  // namespace

/// A chunk being traced, run by run, by everybody who has time.
struct TracedRows::Job {
    Job(const TracedRows& owner, ChunkNumber c)
        : rows(owner), chunk(c), count((owner.layout_.size(c) + run_rows - 1) / run_rows), runs(count) {
        for (auto* column : {&tallies.rays, &tallies.self, &tallies.open, &tallies.back}) column->resize(owner.layout_.size(c));
    }

    /// Takes runs until none is left. Returns when the others' may not be done yet.
    void help() {
        flush_denormals();
        for (;;) {
            const std::size_t k = next++;
            if (k >= count) return;
            std::exception_ptr failed;
            try {
                runs[k] = trace_run(rows.estimator_, rows.layout_, rows.levels_, chunk, static_cast<std::uint32_t>(k), tallies);
            } catch (...) {
                failed = std::current_exception();
            }
            const std::lock_guard lock(mutex);
            if (failed && !error) error = failed;
            if (++done == count) all_done.notify_all();
        }
    }

    void wait() {
        std::unique_lock lock(mutex);
        all_done.wait(lock, [&] { return done == count; });
    }

    const TracedRows& rows;
    ChunkNumber chunk;
    const std::size_t count;  ///< of runs; late helpers look at it when these are gone
    RayTallies tallies;
    std::vector<TracedRun> runs;
    std::atomic<std::size_t> next{0};
    std::mutex mutex;
    std::condition_variable all_done;
    std::size_t done = 0;
    std::exception_ptr error;
};

TracedRows::TracedRows(const Estimator& estimator, const ChunkLayout& layout, LevelPlan levels, std::uint64_t limit_bytes)
    : estimator_(estimator), layout_(layout), levels_(std::move(levels)), limit_bytes_(limit_bytes), known_(layout.chunk_count()) {
    if (levels_.levels.size() != layout.patch_count())
        throw Error(ErrorCode::internal, "traced rows", "levels need one entry per patch");
}

std::uint64_t TracedRows::rays_of_all() const { return planned_rays(levels_, estimator_, 0, layout_.patch_count()); }

std::uint64_t TracedRows::rays_of(ChunkNumber c) const {
    return planned_rays(levels_, estimator_, layout_.first_patch[c], layout_.first_patch[c + 1]);
}

std::uint64_t TracedRows::held_bytes() const {
    const std::lock_guard lock(mutex_);
    return side_bytes_ + whole_bytes_;
}

void TracedRows::forget() {
    const std::lock_guard lock(mutex_);
    sides_.clear();
    whole_.clear();
    side_bytes_ = whole_bytes_ = 0;
}

void TracedRows::leave_out(std::span<const Place> blocks) {
    const std::lock_guard lock(mutex_);
    left_out_.assign(blocks.begin(), blocks.end());
    for (const Place& block : blocks)
        for (const std::uint64_t k : {number(block.a, block.b), number(block.b, block.a)})
            if (const auto found = sides_.find(k); found != sides_.end()) {
                side_bytes_ -= found->second->bytes;
                sides_.erase(found);
            }
}

StripPairs TracedRows::block(Place at) {
    const auto seen = side(at.a, at.b, at), back = at.a == at.b ? seen : side(at.b, at.a, at);
    if (!seen && !back) return {};
    return pooled_block(seen.get(), back.get(), layout_, at.a, at.b);
}

std::uint64_t TracedRows::number(ChunkNumber from, ChunkNumber to) const {
    const std::uint64_t a = std::min(from, to), b = std::max(from, to);
    return 2 * (a * layout_.chunk_count() + b) + (from > to ? 1 : 0);
}

std::shared_ptr<const Side> TracedRows::side(ChunkNumber from, ChunkNumber to, Place at) {
    Lock lock(mutex_);
    for (;;) {
        if (const auto& known = known_[from]; known && !std::binary_search(known->targets.begin(), known->targets.end(), to)) return nullptr;
        if (const auto found = sides_.find(number(from, to)); found != sides_.end()) return found->second;
        if (const auto rows = whole(from)) return rows->side(to);
        if (!job_) return trace(from, at, lock)->side(to);
        wait_for_trace(lock);
    }
}

RayTallies TracedRows::tallies(ChunkNumber c, Place at) {
    Lock lock(mutex_);
    while (!known_[c]) {
        if (!job_) return trace(c, at, lock)->tallies;
        wait_for_trace(lock);
    }
    return known_[c]->tallies;
}

std::shared_ptr<const TracedChunk> TracedRows::whole(ChunkNumber c) {
    const auto found = std::find_if(whole_.begin(), whole_.end(), [&](const auto& entry) { return entry.first == c; });
    if (found == whole_.end()) return nullptr;
    whole_.splice(whole_.begin(), whole_, found);
    return whole_.front().second;
}

void TracedRows::wait_for_trace(Lock& lock) {
    const std::shared_ptr<Job> running = job_;
    lock.unlock();
    running->help();
    lock.lock();
    finished_.wait(lock, [&] { return job_ != running; });
}

std::shared_ptr<const TracedChunk> TracedRows::trace(ChunkNumber c, Place at, Lock& lock) {
    const auto job = job_ = std::make_shared<Job>(*this, c);
    lock.unlock();
    // Idle threads come through the loop, those that want rows through wait_for_trace().
    parallel_isolated(job->count, [&](std::size_t) { job->help(); });
    job->wait();
    rays_traced_ += rays_of(c);
    std::shared_ptr<const TracedChunk> rows;
    if (!job->error) rows = std::make_shared<const TracedChunk>(traced_chunk(std::move(job->runs), std::move(job->tallies)));
    lock.lock();
    job_.reset();
    finished_.notify_all();
    if (job->error) std::rethrow_exception(job->error);
    if (!known_[c]) {
        known_[c].emplace(Known{rows->tallies, {}});
        for (const TracedChunk::Target& target : rows->targets) known_[c]->targets.push_back(target.chunk);
    }
    keep_whole(c, rows);
    keep_sides(c, *rows, at);
    return rows;
}

void TracedRows::keep_whole(ChunkNumber c, std::shared_ptr<const TracedChunk> rows) {
    whole_bytes_ += rows->bytes;
    whole_.emplace_front(c, std::move(rows));
    while (whole_.size() > most_whole || (whole_.size() > 1 && whole_bytes_ > limit_bytes_ / 4)) {
        whole_bytes_ -= whole_.back().second->bytes;
        whole_.pop_back();
    }
}

void TracedRows::keep_sides(ChunkNumber c, const TracedChunk& rows, Place at) {
    struct Candidate {
        std::uint64_t distance, number;
        const std::shared_ptr<const Side>* side;
    };
    const std::uint64_t end = 2 * std::uint64_t{layout_.chunk_count()} * layout_.chunk_count(), position = number(at.a, at.b);
    std::vector<Candidate> candidates;
    for (const TracedChunk::Target& target : rows.targets) {
        const Place block{std::min(c, target.chunk), std::max(c, target.chunk)};
        const bool left_out = std::binary_search(left_out_.begin(), left_out_.end(), block, [](const Place& x, const Place& y) {
            return std::pair(x.a, x.b) < std::pair(y.a, y.b);
        });
        const std::uint64_t k = number(c, target.chunk);
        if (!left_out && !sides_.contains(k)) candidates.push_back({(k + end - position) % end, k, &target.side});
    }
    std::sort(candidates.begin(), candidates.end(), [](const Candidate& x, const Candidate& y) { return x.distance < y.distance; });
    for (const Candidate& candidate : candidates) {
        if (!make_room((*candidate.side)->bytes, position, candidate.distance)) return;
        side_bytes_ += (*candidate.side)->bytes;
        sides_.emplace(candidate.number, *candidate.side);
    }
}

/// Drops what is needed later than `distance` after `position`, the latest first, until there is room. False if there is not enough.
bool TracedRows::make_room(std::uint64_t bytes, std::uint64_t position, std::uint64_t distance) {
    const std::uint64_t end = 2 * std::uint64_t{layout_.chunk_count()} * layout_.chunk_count();
    while (side_bytes_ + whole_bytes_ + bytes > limit_bytes_) {
        if (sides_.empty()) return false;
        auto last = sides_.lower_bound(position);  // what was just passed is needed latest
        if (last == sides_.begin()) last = sides_.end();
        --last;
        if ((last->first + end - position) % end <= distance) return false;
        side_bytes_ -= last->second->bytes;
        sides_.erase(last);
    }
    return true;
}

}  // namespace luxel
