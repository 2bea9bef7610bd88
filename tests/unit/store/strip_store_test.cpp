/// Strips as the solvers read them: sizes, areas, and refusal of everything that does not fit.
#include "baker/store/strip_store.h"

#include <gtest/gtest.h>

#include "baker/core/parallel.h"
#include "baker/store/closed_matrix.h"
#include "tests/support/damage.h"
#include "tests/unit/store/made_evidence.h"

namespace luxel {
namespace {

using test::MadeEvidence;
using test::TemporaryFolder;

struct MadeStore {
    explicit MadeStore(const std::vector<std::uint32_t>& sizes, std::size_t targets = 8)
        : evidence(test::random_evidence(sizes, targets, 2, 1)),
          strips(pool(folder, evidence, test::write_evidence(folder.path(), evidence.records, 100, 30), "strips")) {}
    TemporaryFolder folder;
    MadeEvidence evidence;
    std::filesystem::path strips;
    [[nodiscard]] bool opens(const Key& key, const ChunkLayout& layout) const {
        return !test::refused({}, [&](ByteView) { StripStore(strips, key, layout); });
    }
};

TEST(StripStore, BlocksInOrderAndInWholePages) {
    const MadeStore made({30, 20, 90, 5});
    const StripStore store(made.strips, test::strip_key, made.evidence.layout);
    ASSERT_EQ(store.blocks().size(), store.block_count());
    ASSERT_GT(store.block_count(), 4u);
    std::uint64_t pairs = 0, stored = 0, file_bytes = 0;
    CountBlock block;
    for (std::size_t k = 0; k < store.block_count(); ++k) {
        const BlockInfo& info = store.blocks()[k];
        EXPECT_LE(info.a, info.b);
        if (k) {
            EXPECT_LT(std::pair(store.blocks()[k - 1].a, store.blocks()[k - 1].b), std::pair(info.a, info.b));
        }
        EXPECT_GT(info.pair_count, 0u);
        EXPECT_EQ(info.read_bytes % 4096, 0u);
        EXPECT_GT(info.read_bytes, 0u);
        store.load(k, block);
        EXPECT_EQ(block.a, info.a);
        EXPECT_EQ(block.b, info.b);
        EXPECT_EQ(block.counts.size(), info.pair_count);
        EXPECT_EQ(block.row_begin.size(), store.layout().size(info.a) + 1u);
        pairs += info.pair_count;
        stored += info.read_bytes;
    }
    for (ChunkNumber a = 0; a < 4; ++a) file_bytes += std::filesystem::file_size(strip_path(made.strips, a));
    EXPECT_EQ(store.pair_count(), pairs);
    EXPECT_EQ(store.file_bytes(), file_bytes);
    EXPECT_LT(stored, file_bytes + 4096 * store.block_count());
}

/// More strips than are kept open, read by several threads in no order.
TEST(StripStore, ManyStripsManyThreads) {
    const MadeStore made(std::vector<std::uint32_t>(300, 2), 3);
    const StripStore store(made.strips, test::strip_key, made.evidence.layout);
    const auto expected = made.evidence.pooled();
    std::atomic<std::size_t> wrong{0};
    parallel_for(2000, 1, [&](std::size_t k) {
        const std::size_t index = k * 7919 % store.block_count();
        CountBlock block;
        store.load(index, block);
        for (std::uint32_t row = 0; row < 2; ++row)
            for (std::uint32_t p = block.row_begin[row]; p < block.row_begin[row + 1]; ++p) {
                const auto at = expected.find({2 * block.a + row, 2 * block.b + block.columns[p]});
                wrong += at == expected.end() || at->second != block.counts[p];
            }
    });
    EXPECT_EQ(wrong, 0u);
}

TEST(StripStore, RefusesWhatDoesNotFit) {
    const MadeStore made({30, 20});
    EXPECT_TRUE(made.opens(test::strip_key, made.evidence.layout));
    EXPECT_FALSE(made.opens({1, 2}, made.evidence.layout)) << "another key";
    ChunkLayout layout = made.evidence.layout;
    layout.first_patch = {0, 29, 50};
    EXPECT_FALSE(made.opens(test::strip_key, layout)) << "other sizes";
    layout.first_patch = {0, 30, 50, 60};
    EXPECT_FALSE(made.opens(test::strip_key, layout)) << "a strip too few";
    layout.first_patch = {0, 30};
    EXPECT_FALSE(made.opens(test::strip_key, layout)) << "blocks with chunks that do not exist";
}

TEST(StripStore, RefusesColumnsThatDoNotFit) {
    // The tallies of strip 0 fit both layouts; its block with chunk 1 is wider than the chunk.
    const MadeStore made({10, 5}), other({10, 6});
    std::filesystem::copy_file(strip_path(other.strips, 0), strip_path(made.strips, 0),
                               std::filesystem::copy_options::overwrite_existing);
    const StripStore store(made.strips, test::strip_key, made.evidence.layout);
    CountBlock block;
    EXPECT_TRUE(test::refused({}, [&](ByteView) {
        for (std::size_t k = 0; k < store.block_count(); ++k) store.load(k, block);
    }));
}

TEST(StripStore, RefusesDamage) {
    const MadeStore made({8, 5});
    const auto path = strip_path(made.strips, 0);
    const Bytes whole = read_file(path);
    for (std::size_t at = 0; at < whole.size(); at += 3) {
        Bytes bytes = whole;
        bytes[at] = static_cast<std::uint8_t>(bytes[at] ^ 0x40);
        publish_file(path, bytes);
        EXPECT_TRUE(test::refused({},
                                  [&](ByteView) {
                                      const StripStore store(made.strips, test::strip_key, made.evidence.layout);
                                      CountBlock block;
                                      for (std::size_t k = 0; k < store.block_count(); ++k) store.load(k, block);
                                  }))
            << "byte " << at;
    }
    std::filesystem::remove(path);
    EXPECT_FALSE(made.opens(test::strip_key, made.evidence.layout)) << "missing";
}

TEST(ClosedMatrix, AreasFollowFromCountsAndMultipliers) {
    const MadeStore made({12, 7, 9});
    const StripStore store(made.strips, test::strip_key, made.evidence.layout);
    const std::size_t patches = made.evidence.ids.size();
    Closure closure;
    std::vector<double> area_m2;
    for (std::size_t p = 0; p < patches; ++p) {
        closure.mu.push_back(1 + 0.1 * static_cast<double>(p));
        closure.diagonal_m2.push_back(1e-3 * static_cast<double>(p));
        area_m2.push_back(2 + static_cast<double>(p));
    }
    ClosedMatrix strips(store, area_m2, closure);
    EXPECT_EQ(strips.area_m2().data(), area_m2.data());
    EXPECT_EQ(strips.diagonal_m2()[3], 3e-3);
    const auto counts = made.evidence.pooled();
    std::uint64_t expected_bytes = 0;
    std::size_t found = 0;
    Block block;
    for (std::size_t k = 0; k < strips.blocks().size(); ++k) {
        strips.load(k, block);
        expected_bytes += strips.blocks()[k].read_bytes;
        EXPECT_EQ(strips.bytes_read(), expected_bytes);
        for (std::uint32_t row = 0; row + 1 < block.row_begin.size(); ++row)
            for (std::uint32_t p = block.row_begin[row]; p < block.row_begin[row + 1]; ++p, ++found) {
                const PatchNumber i = store.layout().first_patch[block.a] + row;
                const PatchNumber j = store.layout().first_patch[block.b] + block.columns[p];
                const auto count = static_cast<double>(counts.at({i, j}));
                EXPECT_EQ(block.areas_m2[p], static_cast<float>(count / (closure.mu[i] + closure.mu[j])));
            }
    }
    EXPECT_EQ(found, counts.size());
    EXPECT_EQ(strips.bytes_read(), strips.total_bytes());
}

}  // namespace
}  // namespace luxel
