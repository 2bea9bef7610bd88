// Which patches a chain of pairs joins to light.
#include "baker/accuracy/dark_patches.h"

#include <gtest/gtest.h>

#include "baker/formfactors/memory_blocks.h"

namespace luxel {
namespace {

/// Patches in three chunks of three, joined as told.
MemoryBlocks matrix(const std::vector<std::pair<PatchNumber, PatchNumber>>& pairs) {
    std::vector<ExchangePair> entries;
    for (const auto& [i, j] : pairs) entries.push_back({i, j, 1});
    return {ChunkLayout{{0, 3, 6, 9}}, std::vector<double>(9, 1), std::vector<double>(9, 0), std::move(entries)};
}

using Dark = std::vector<std::uint8_t>;

TEST(DarkPatches, AreThoseThatNoChainJoinsToLight) {
    // 0 - 1 - 4 - 8 hang together, 2 - 5 too, and 3 - 6; 7 is alone.
    MemoryBlocks pairs = matrix({{0, 1}, {1, 4}, {4, 8}, {2, 5}, {3, 6}});
    EXPECT_EQ(find_dark_patches(pairs, {false, false, false, false, false, false, false, false, true}), (Dark{0, 0, 1, 1, 0, 1, 1, 1, 0}));
    EXPECT_EQ(find_dark_patches(pairs, {true, false, false, false, false, true, false, false, false}), (Dark{0, 0, 0, 1, 0, 0, 1, 1, 0}));
    EXPECT_EQ(find_dark_patches(pairs, std::vector<bool>(9)), Dark(9, 1)) << "no light at all";
    EXPECT_TRUE(find_dark_patches(pairs, {true, false, true, true, false, false, false, true, false}).empty()) << "all are joined to some";
}

TEST(DarkPatches, ReadNoBlockOfChunksThatAreLit) {
    MemoryBlocks pairs = matrix({{0, 1}, {1, 4}, {4, 8}, {6, 7}});
    EXPECT_TRUE(find_dark_patches(pairs, std::vector<bool>(9, true)).empty());
    EXPECT_EQ(pairs.bytes_read(), 0u);
    // Only the last chunk has any to ask about: its own block, and that which joins it to the second.
    EXPECT_EQ(find_dark_patches(pairs, {true, true, true, true, true, true, false, false, false}), (Dark{0, 0, 0, 0, 0, 0, 1, 1, 0}));
    EXPECT_EQ(pairs.bytes_read(), 2u * 4096u);
}

}  // namespace
}  // namespace luxel
