/// One pass over all pairs of the matrix with sums per patch: the loop under everything in this room.
#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "baker/core/parallel.h"
#include "baker/formfactors/block_source.h"

namespace luxel {

template <std::size_t Width>
using PatchSums = std::vector<std::array<double, Width>>;

/// Calls pair(i, j, area_m2, sums_i, sums_j) once for every pair i != j, which adds to the sums of both. Sums of a block
/// are collected apart and added in block order: the result does not depend on the number of threads. The diagonal is the
/// caller's. Memory: 8 * Width bytes per patch, and those of 16 pairs of chunks. Throws what source.load() throws.
template <std::size_t Width, class Pair>
PatchSums<Width> sum_over_pairs(BlockSource& source, const Pair& pair) {
    constexpr std::size_t batch_blocks = 16;
    struct Part {
        PatchSums<Width> rows_a, rows_b;
    };
    const ChunkLayout& layout = source.layout();
    PatchSums<Width> sums(layout.patch_count(), std::array<double, Width>{});
    std::vector<Part> parts(batch_blocks);
    const std::size_t count = source.blocks().size();
    const auto sum_block = [&](std::size_t index, Part& part) {
        Block block;
        source.load(index, block);
        part.rows_a.assign(layout.size(block.a), std::array<double, Width>{});
        part.rows_b.assign(layout.size(block.b), std::array<double, Width>{});
        const PatchNumber first_a = layout.first_patch[block.a], first_b = layout.first_patch[block.b];
        for (std::uint32_t row = 0; row + 1 < block.row_begin.size(); ++row)
            for (std::uint32_t k = block.row_begin[row]; k < block.row_begin[row + 1]; ++k)
                pair(first_a + row, first_b + block.columns[k], static_cast<double>(block.areas_m2[k]), part.rows_a[row],
                     part.rows_b[block.columns[k]]);
    };
    const auto add = [&](ChunkNumber chunk, const PatchSums<Width>& rows) {
        for (std::size_t r = 0; r < rows.size(); ++r)
            for (std::size_t w = 0; w < Width; ++w) sums[layout.first_patch[chunk] + r][w] += rows[r][w];
    };
    for (std::size_t first = 0; first < count; first += batch_blocks) {
        const std::size_t batch = std::min(batch_blocks, count - first);
        parallel_for(batch, 1, [&](std::size_t k) { sum_block(first + k, parts[k]); });
        for (std::size_t k = 0; k < batch; ++k) {
            add(source.blocks()[first + k].a, parts[k].rows_a);
            add(source.blocks()[first + k].b, parts[k].rows_b);
        }
    }
    return sums;
}

}  // namespace luxel
