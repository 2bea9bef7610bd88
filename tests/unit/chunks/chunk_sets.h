/// Chunks as lists of stable ids, so that they can be compared between two numberings.
#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <vector>

#include "baker/chunks/spatial_tiles.h"

namespace luxel::test {

/// Ids of the patches of each chunk, in their order.
inline std::vector<std::vector<PatchId>> chunks_of(const PatchSet& set, const Tiling& tiling) {
    std::vector<PatchId> by_number(set.count());
    for (std::size_t old = 0; old < set.count(); ++old) by_number.at(tiling.new_number[old]) = set.patches[old].id;
    std::vector<std::vector<PatchId>> chunks;
    for (ChunkNumber c = 0; c < tiling.layout.chunk_count(); ++c)
        chunks.emplace_back(by_number.begin() + tiling.layout.first_patch[c],
                            by_number.begin() + tiling.layout.first_patch[c + 1]);
    return chunks;
}

/// The same without order, of the chunks and in them.
inline std::set<std::set<PatchId>> chunk_sets(const PatchSet& set, const Tiling& tiling) {
    std::set<std::set<PatchId>> sets;
    for (const auto& chunk : chunks_of(set, tiling)) sets.emplace(chunk.begin(), chunk.end());
    return sets;
}

/// Every patch has one number, no chunk is empty or larger than `limit`, and inside a chunk the old order is kept.
inline void expect_valid(const PatchSet& set, const Tiling& tiling, std::uint32_t limit) {
    std::vector<bool> used(set.count());
    ASSERT_EQ(tiling.new_number.size(), set.count());
    for (const PatchNumber number : tiling.new_number) {
        ASSERT_LT(number, set.count());
        EXPECT_FALSE(used[number]) << "a number is given twice";
        used[number] = true;
    }
    ASSERT_EQ(tiling.layout.first_patch.front(), 0u);
    ASSERT_EQ(tiling.layout.patch_count(), set.count());
    std::vector<PatchNumber> old_number(set.count());
    for (PatchNumber old = 0; old < set.count(); ++old) old_number[tiling.new_number[old]] = old;
    for (ChunkNumber c = 0; c < tiling.layout.chunk_count(); ++c) {
        EXPECT_GE(tiling.layout.size(c), 1u);
        EXPECT_LE(tiling.layout.size(c), limit);
        EXPECT_TRUE(std::is_sorted(old_number.begin() + tiling.layout.first_patch[c],
                                   old_number.begin() + tiling.layout.first_patch[c + 1]));
    }
}

}  // namespace luxel::test
