#include "baker/store/traced_chunk.h"

#include <algorithm>
#include <map>

#include "baker/store/ray_sum.h"

namespace luxel {
namespace {

const std::string where_from = "rays traced again";

/// What one patch met: other patches, ascending, with their counts.
struct Row {
    std::vector<PatchNumber> targets;
    std::vector<std::uint32_t> counts;
};

/// Tallies of one patch go to place `at`.
Row count_landings(PatchNumber patch, const std::vector<Landings>& all, RayTallies& tallies, std::size_t at) {
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
TracedRun cut(const std::vector<Row>& rows, std::uint32_t first_row, const ChunkLayout& layout) {
    std::vector<ChunkNumber> chunks;
    for (const Row& row : rows)
        for (std::size_t k = 0; k < row.targets.size();) {
            chunks.push_back(layout.chunk_of(row.targets[k]));
            const PatchNumber end = layout.first_patch[chunks.back() + 1];
            while (k < row.targets.size() && row.targets[k] < end) ++k;
        }
    std::sort(chunks.begin(), chunks.end());
    chunks.erase(std::unique(chunks.begin(), chunks.end()), chunks.end());
    TracedRun run;
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
        run.sides.emplace_back(chunk, SideRun{first_row, pairs.rows, pack_pairs(pairs)});
    }
    return run;
}

/// The whole side, rows x columns.
StripPairs unpacked(const Side* side, std::uint32_t rows, std::uint32_t columns) {
    StripPairs all{rows, columns, {0}, {}, {}};
    const auto fill_to = [&](std::uint32_t row) { all.row_begin.resize(row + 1u, static_cast<std::uint32_t>(all.column.size())); };
    if (side)
        for (const SideRun& run : side->runs) {
            fill_to(run.first_row);
            const auto before = static_cast<std::uint32_t>(all.column.size());
            const StripPairs part = unpack_pairs(BlockFileWriter::unpack(run.pairs, where_from), false, where_from);
            for (std::uint32_t row = 0; row < part.rows; ++row) all.row_begin.push_back(before + part.row_begin[row + 1]);
            all.column.insert(all.column.end(), part.column.begin(), part.column.end());
            all.count.insert(all.count.end(), part.count.begin(), part.count.end());
        }
    fill_to(rows);
    return all;
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

std::shared_ptr<const Side> TracedChunk::side(ChunkNumber target) const {
    const auto at = std::lower_bound(targets.begin(), targets.end(), target,
                                     [](const Target& t, ChunkNumber chunk) { return t.chunk < chunk; });
    return at != targets.end() && at->chunk == target ? at->side : nullptr;
}

TracedRun trace_run(const Estimator& estimator, const ChunkLayout& layout, const LevelPlan& levels, ChunkNumber chunk,
                    std::uint32_t run, RayTallies& tallies) {
    const std::uint32_t first_row = run * run_rows;
    std::vector<Row> rows(std::min(run_rows, layout.size(chunk) - first_row));
    std::vector<Landings> landings;
    for (std::uint32_t r = 0; r < rows.size(); ++r) {
        const PatchNumber patch = layout.first_patch[chunk] + first_row + r;
        if (levels.levels[patch].empty()) continue;
        estimator.cast(patch, levels.levels[patch], landings);
        rows[r] = count_landings(patch, landings, tallies, first_row + r);
    }
    return cut(rows, first_row, layout);
}

TracedChunk traced_chunk(std::vector<TracedRun> runs, RayTallies tallies) {
    TracedChunk chunk;
    std::map<ChunkNumber, std::shared_ptr<Side>> sides;
    for (TracedRun& run : runs)
        for (auto& [target, part] : run.sides) {
            auto& side = sides[target];
            if (!side) side = std::make_shared<Side>(), side->bytes = sizeof(Side);
            side->bytes += sizeof(SideRun) + part.pairs.stored.capacity();
            side->runs.push_back(std::move(part));
        }
    chunk.tallies = std::move(tallies);
    chunk.bytes = sizeof chunk + chunk.tallies.rays.size() * 4 * sizeof(std::uint32_t);
    for (auto& [target, side] : sides) {
        chunk.bytes += sizeof(TracedChunk::Target) + side->bytes;
        chunk.targets.push_back({target, std::move(side)});
    }
    return chunk;
}

StripPairs pooled_block(const Side* a_to_b, const Side* b_to_a, const ChunkLayout& layout, ChunkNumber a, ChunkNumber b) {
    const StripPairs seen = unpacked(a_to_b, layout.size(a), layout.size(b));
    if (a == b) return sum(half(seen, true), transposed(half(seen, false)));
    return sum(seen, transposed(unpacked(b_to_a, layout.size(b), layout.size(a))));
}

}  // namespace luxel
