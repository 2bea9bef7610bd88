/// The cache changes how much is read, never what.
#include "baker/store/block_cache.h"

#include <gtest/gtest.h>

#include <random>

#include "baker/core/parallel.h"
#include "baker/formfactors/memory_blocks.h"

namespace luxel {
namespace {

/// Blocks of very different sizes.
MemoryBlocks made_blocks() {
    ChunkLayout layout;
    layout.first_patch = {0, 10, 11, 60, 64, 90};
    std::mt19937_64 random(1);
    std::vector<ExchangePair> pairs;
    for (PatchNumber i = 0; i < 90; ++i)
        for (PatchNumber j = i + 1; j < 90; ++j)
            if (random() % 3 == 0) pairs.push_back({i, j, static_cast<float>(1 + random() % 100)});
    return {layout, std::vector<double>(90, 1.0), std::vector<double>(90, 0.0), pairs};
}

bool same(const Block& x, const Block& y) {
    return x.a == y.a && x.b == y.b && x.row_begin == y.row_begin && x.columns == y.columns && x.areas_m2 == y.areas_m2;
}

TEST(BlockCache, NeverChangesABlock) {
    MemoryBlocks source = made_blocks(), reference = made_blocks();
    const std::size_t count = source.blocks().size();
    for (const std::uint64_t limit : {0ULL, 100ULL, 3000ULL, 1ULL << 30}) {
        BlockCache cache(source, limit);
        std::mt19937_64 random(2);
        Block cached, direct;
        for (int k = 0; k < 500; ++k) {
            const std::size_t index = random() % count;
            cache.load(index, cached);
            reference.load(index, direct);
            ASSERT_TRUE(same(cached, direct));
            ASSERT_LE(cache.held_bytes(), limit);
        }
        EXPECT_EQ(cache.hits() == 0, limit < 100) << limit;
        EXPECT_EQ(cache.blocks().data(), source.blocks().data());
    }
}

TEST(BlockCache, ReadsOnlyWhatIsNotHeld) {
    MemoryBlocks source = made_blocks();
    BlockCache cache(source, 1 << 30);
    Block block;
    std::uint64_t held = 0;
    for (int round = 0; round < 3; ++round)
        for (std::size_t k = 0; k < source.blocks().size(); ++k) {
            cache.load(k, block);
            if (round == 0) held += BlockCache::resident_bytes(block);
        }
    EXPECT_EQ(cache.bytes_read(), source.total_bytes()) << "once each";
    EXPECT_EQ(cache.hits(), 2 * source.blocks().size());
    EXPECT_EQ(cache.held_bytes(), held);
}

TEST(BlockCache, LeastRecentlyUsedGoesFirst) {
    MemoryBlocks source = made_blocks();
    Block block;
    std::vector<std::uint64_t> size;
    for (std::size_t k = 0; k < 3; ++k) source.load(k, block), size.push_back(BlockCache::resident_bytes(block));
    // Room for any two of the first three blocks, not for all of them.
    BlockCache cache(source, size[0] + size[1] + size[2] - 1);
    const auto reads = [&](std::size_t index) {
        const std::uint64_t before = source.bytes_read();
        cache.load(index, block);
        return source.bytes_read() != before;
    };
    EXPECT_TRUE(reads(0));
    EXPECT_TRUE(reads(1));
    EXPECT_FALSE(reads(0));
    EXPECT_TRUE(reads(2)) << "1 is the oldest now and goes";
    EXPECT_FALSE(reads(0));
    EXPECT_TRUE(reads(1));
}

TEST(BlockCache, ManyThreads) {
    MemoryBlocks source = made_blocks(), reference = made_blocks();
    BlockCache cache(source, 4000);
    std::atomic<int> wrong{0};
    parallel_for(4000, 1, [&](std::size_t k) {
        Block cached, direct;
        const std::size_t index = k * k % source.blocks().size();
        cache.load(index, cached);
        reference.load(index, direct);
        wrong += !same(cached, direct);
    });
    EXPECT_EQ(wrong, 0);
    EXPECT_LE(cache.held_bytes(), 4000u);
}

}  // namespace
}  // namespace luxel
