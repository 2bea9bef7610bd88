#include "baker/formfactors/memory_blocks.h"

#include <gtest/gtest.h>

#include "formats/base/error.h"

namespace luxel {
namespace {

const ChunkLayout two_chunks{{0, 2, 5}};

MemoryBlocks make(std::vector<ExchangePair> pairs) {
    return {two_chunks, std::vector<double>(5, 1.0), std::vector<double>(5, 0.0), std::move(pairs)};
}

TEST(MemoryBlocks, CutsPairsIntoSortedBlocks) {
    MemoryBlocks blocks = make({{4, 0, 0.4f}, {1, 0, 0.1f}, {2, 0, 0.2f}, {4, 3, 0.3f}});
    ASSERT_EQ(blocks.blocks().size(), 3u);
    Block block;
    blocks.load(1, block);
    EXPECT_EQ(block.a, 0u);
    EXPECT_EQ(block.b, 1u);
    EXPECT_EQ(block.row_begin, (std::vector<std::uint32_t>{0, 2, 2}));
    EXPECT_EQ(block.columns, (std::vector<std::uint16_t>{0, 2}));
    EXPECT_EQ(block.areas_m2, (std::vector<float>{0.2f, 0.4f}));
    blocks.load(2, block);
    EXPECT_EQ(block.a, 1u);
    EXPECT_EQ(block.b, 1u);
    EXPECT_EQ(block.row_begin, (std::vector<std::uint32_t>{0, 0, 1, 1}));
    EXPECT_EQ(block.columns, (std::vector<std::uint16_t>{2}));
}

TEST(MemoryBlocks, CountsWholePages) {
    std::vector<ExchangePair> pairs;
    for (PatchNumber i = 0; i < 40; ++i)
        for (PatchNumber j = i + 1; j < 40; ++j) pairs.push_back({i, j, 1.0f});
    MemoryBlocks blocks(ChunkLayout{{0, 40}}, std::vector<double>(40, 1.0), std::vector<double>(40, 0.0), pairs);
    EXPECT_EQ(blocks.total_bytes(), 8192u);  // 780 pairs of 8 bytes
    Block block;
    blocks.load(0, block);
    blocks.load(0, block);
    EXPECT_EQ(blocks.bytes_read(), 16384u);
}

TEST(MemoryBlocks, RefusesWhatIsNoMatrix) {
    EXPECT_THROW(make({{0, 5, 1.0f}}), Error);
    EXPECT_THROW(make({{2, 2, 1.0f}}), Error);
    EXPECT_THROW(make({{2, 3, 0.0f}}), Error);
    EXPECT_THROW(make({{2, 3, 1.0f}, {3, 2, 1.0f}}), Error);
    EXPECT_THROW(MemoryBlocks(two_chunks, {1, 1}, {0, 0}, {}), Error);
    EXPECT_EQ(make({}).blocks().size(), 0u);
}

}  // namespace
}  // namespace luxel
