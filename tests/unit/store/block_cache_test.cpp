/// The cache changes how much is read, never what.
#include "baker/store/block_cache.h"
#include "formats/base/error.h"

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

TEST(BlockCache, ReadsAheadWhatIsExpected) {
    MemoryBlocks source = made_blocks(), reference = made_blocks();
    for (int round = 0; round < 50; ++round) {
        BlockCache cache(source, 1 << 20, true);
        const std::uint64_t before = source.bytes_read();
        const std::vector<std::size_t> some{2, 0, 1};
        cache.expect(some);
        // Asked for before, while and after the thread has read them: each is read once, and right.
        for (const std::size_t index : {1, 2, 0, 2, 1}) {
            Block direct;
            reference.load(index, direct);
            EXPECT_TRUE(same(*cache.share(index), direct));
        }
        std::uint64_t bytes = 0;
        for (const std::size_t index : some) bytes += source.blocks()[index].read_bytes;
        EXPECT_EQ(source.bytes_read() - before, bytes);
        cache.expect(some);  // nothing to do; and the cache may go while something is expected
        if (round % 2) cache.expect(std::vector<std::size_t>{3});
    }
}

TEST(BlockCache, ReadsAheadOnlyWhatHalfOfItHolds) {
    MemoryBlocks source = made_blocks();
    BlockCache cache(source, 8, true);
    cache.expect(std::vector<std::size_t>{0, 1, 2});
    EXPECT_EQ(source.bytes_read(), 0u);
    EXPECT_GT(cache.share(0)->areas_m2.size(), 0u) << "a cache that holds nothing still gives everything";
}

TEST(BlockCache, ABlockThatCannotBeReadAheadIsToldToWhoAsks) {
    class Damaged final : public BlockSource {
      public:
        explicit Damaged(BlockSource& source) : source_(source) {}
        [[nodiscard]] const ChunkLayout& layout() const override { return source_.layout(); }
        [[nodiscard]] std::span<const double> area_m2() const override { return source_.area_m2(); }
        [[nodiscard]] std::span<const double> diagonal_m2() const override { return source_.diagonal_m2(); }
        [[nodiscard]] std::span<const BlockInfo> blocks() const override { return source_.blocks(); }
        void load(std::size_t, Block&) override { throw Error(ErrorCode::damaged_store, "strip-0.lxs", "checksum mismatch"); }
        [[nodiscard]] std::uint64_t bytes_read() const override { return 0; }

      private:
        BlockSource& source_;
    };
    MemoryBlocks source = made_blocks();
    Damaged damaged(source);
    BlockCache cache(damaged, 1 << 20, true);
    cache.expect(std::vector<std::size_t>{0});
    EXPECT_THROW((void)cache.share(0), Error);
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
