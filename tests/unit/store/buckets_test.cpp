/// Buckets give back what was put in, from memory or from the scratch file.
#include "baker/store/buckets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cerrno>
#include <map>
#include <random>

#include "baker/store/pair_sort.h"
#include "formats/base/error.h"
#include "tests/support/disk_faults.h"
#include "tests/support/file_limit.h"
#include "tests/support/temporary_folder.h"

namespace luxel {
namespace {

/// (b, row, column) -> sum of counts.
using Sums = std::map<std::uint64_t, std::uint64_t>;

Sums sums_of(const PairBuckets& buckets, std::uint32_t bucket, std::uint64_t* entries = nullptr) {
    Sums sums;
    std::uint64_t count = 0;
    buckets.visit(bucket, [&](std::span<const PackedPair> run) {
        for (const PackedPair pair : run) sums[pair_place(pair)] += pair_count(pair);
        count += run.size();
    });
    if (entries) *entries = count;
    return sums;
}

void add(PairBuckets& buckets, std::uint32_t bucket, std::uint32_t b, std::uint32_t row, std::uint32_t column, std::uint32_t count) {
    std::vector<PackedPair> pairs;
    append_pairs(pairs, b, row, column, count);
    buckets.add(bucket, pairs);
}

TEST(PairBuckets, PackedOrderIsBlockRowColumn) {
    EXPECT_LT(pack_pair(1, 65535, 65535, 65535), pack_pair(2, 0, 0, 0));
    EXPECT_LT(pack_pair(1, 3, 65535, 65535), pack_pair(1, 4, 0, 0));
    EXPECT_LT(pack_pair(1, 3, 8, 65535), pack_pair(1, 3, 9, 0));
    const PackedPair pair = pack_pair(65535, 65534, 65533, 65532);
    EXPECT_EQ(pair_chunk(pair), 65535u);
    EXPECT_EQ(pair_count(pair), 65532u);
    EXPECT_EQ(pair_place(pair), 65535ULL << 32 | 65534ULL << 16 | 65533ULL);
}

TEST(PairBuckets, GiveBackWhatWasPutIn) {
    for (const std::uint64_t memory_bytes : {0ULL, 1000ULL, 1ULL << 30}) {
        const test::TemporaryFolder folder;
        PairBuckets buckets(3, memory_bytes, folder.path());
        std::mt19937_64 random(1);
        std::array<Sums, 3> expected;
        for (int k = 0; k < 20000; ++k) {
            const auto bucket = static_cast<std::uint32_t>(random() % 2 * 2);  // the middle one stays empty
            const auto b = static_cast<std::uint32_t>(random() % 65536), row = static_cast<std::uint32_t>(random() % 4);
            const auto column = static_cast<std::uint32_t>(65535 - random() % 3);
            const auto count =
                static_cast<std::uint32_t>(random() % 100 ? 1 + random() % 9 : 65534 + random() % 200000);
            add(buckets, bucket, b, row, column, count);
            expected[bucket][pair_place(pack_pair(b, row, column, 0))] += count;
            if (k % 500 == 0) buckets.settle();
        }
        for (std::uint32_t bucket = 0; bucket < 3; ++bucket) {
            std::uint64_t entries = 0;
            EXPECT_EQ(sums_of(buckets, bucket, &entries), expected[bucket]);
            EXPECT_EQ(buckets.size(bucket), entries);
        }
        EXPECT_TRUE(std::filesystem::is_empty(folder.path())) << "the scratch file has no name";
        buckets.release(1);
        EXPECT_EQ(buckets.size(1), 0u);
    }
}

TEST(PairBuckets, LongRunsComeInPieces) {
    const test::TemporaryFolder folder;
    PairBuckets buckets(1, 0, folder.path());
    constexpr std::uint32_t count = 300000;
    for (std::uint32_t k = 0; k < count; ++k) add(buckets, 0, k >> 16, k & 0xffff, 0, 1);
    buckets.settle();
    std::uint64_t longest = 0, sum = 0, runs = 0;
    buckets.visit(0, [&](std::span<const PackedPair> run) {
        longest = std::max<std::uint64_t>(longest, run.size());
        sum += run.size();
        runs += !run.empty();
    });
    EXPECT_EQ(sum, count);
    EXPECT_GT(runs, 2u);
    EXPECT_LE(longest, 1u << 17);
}

TEST(PairBuckets, SaysWhenItCannotWrite) {
    PairBuckets buckets(1, 0, "/proc/no such folder");
    add(buckets, 0, 0, 0, 0, 1);
    try {
        buckets.settle();
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.code, ErrorCode::cannot_write);
        EXPECT_FALSE(error.hint.empty());
    }
}

TEST(PairSort, EqualsStableSortByPlace) {
    std::mt19937_64 random(2);
    struct Bounds {
        std::uint32_t chunk, side;
    };
    for (const Bounds& bounds : {Bounds{1, 1}, {1, 65536}, {65536, 1}, {3, 2049}, {70, 2048}, {65536, 65536}})
        for (const std::size_t count : {0u, 1u, 2u, 1000u, 30000u}) {
            std::vector<PackedPair> pairs(count);
            for (PackedPair& pair : pairs)
                pair = pack_pair(static_cast<std::uint32_t>(random() % bounds.chunk),
                                 static_cast<std::uint32_t>(random() % bounds.side),
                                 static_cast<std::uint32_t>(random() % bounds.side),
                                 static_cast<std::uint32_t>(random() % 65536));
            std::vector<PackedPair> expected = pairs;
            std::ranges::stable_sort(expected, {}, pair_place);
            sort_pairs(pairs, bounds.chunk, bounds.side);
            EXPECT_EQ(pairs, expected) << bounds.chunk << ", " << bounds.side;
        }
}

TEST(PairBuckets, AFullDiskIsToldWithItsByte) {
    const test::TemporaryFolder folder;
    PairBuckets buckets(3, 0, folder.path());
    for (std::uint32_t k = 0; k < 600; ++k) add(buckets, k % 3, 0, k, k + 1, 1);
    {
        const test::FileLimit limit(3000);
        try {
            buckets.settle();
            ADD_FAILURE() << "nothing was thrown";
        } catch (const Error& error) {
            EXPECT_EQ(error.code, ErrorCode::cannot_write);
            EXPECT_EQ(error.where, folder.path().string());
            EXPECT_NE(error.what_text.find("at byte 3000: "), std::string::npos) << error.what_text;
        }
    }
    EXPECT_TRUE(std::filesystem::is_empty(folder.path())) << "the scratch file has no name";
}

TEST(PairBuckets, AReadErrorIsToldWithItsByte) {
    const test::TemporaryFolder folder;
    PairBuckets buckets(1, 0, folder.path());
    constexpr std::uint32_t count = 300000;  // three runs of the scratch file
    for (std::uint32_t k = 0; k < count; ++k) add(buckets, 0, k >> 16, k & 0xffff, 0, 1);
    buckets.settle();
    const Sums whole = sums_of(buckets, 0);
    for (std::uint64_t first = 0; first < 3; ++first) {
        const test::DiskFault fault(test::DiskCall::read, "pooling-", first, EIO);
        try {
            sums_of(buckets, 0);
            ADD_FAILURE() << "nothing was thrown";
        } catch (const Error& error) {
            EXPECT_EQ(error.code, ErrorCode::damaged_store);
            EXPECT_EQ(error.where, folder.path().string());
            EXPECT_NE(error.what_text.find("at byte " + std::to_string(first << 20) + ": Input/output error"),
                      std::string::npos)
                << error.what_text;
            EXPECT_FALSE(error.hint.empty());
        }
    }
    EXPECT_EQ(sums_of(buckets, 0), whole) << "the disk has recovered";
    const test::DiskFault pieces(test::DiskCall::read, "pooling-", 0, 0);
    PairBuckets few(1, 0, folder.path());
    for (std::uint32_t k = 0; k < 100; ++k) add(few, 0, k, k, 0, 1 + k);
    few.settle();
    EXPECT_EQ(sums_of(few, 0).size(), 100u) << "reads that give only a part";
    EXPECT_GT(pieces.calls(), 100u);
}

}  // namespace
}  // namespace luxel
