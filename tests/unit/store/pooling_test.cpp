/// Pooling against plain counting, and its independence of cut, order, memory and threads.
#include "baker/store/pooling.h"

#include <gtest/gtest.h>

#include "baker/core/parallel.h"
#include "tests/support/damage.h"
#include "tests/unit/store/made_evidence.h"

namespace luxel {
namespace {

using test::MadeEvidence;
using test::TemporaryFolder;

std::vector<Bytes> strip_bytes(const std::filesystem::path& folder, const ChunkLayout& layout) {
    std::vector<Bytes> all;
    for (ChunkNumber a = 0; a < layout.chunk_count(); ++a) all.push_back(read_file(strip_path(folder, a)));
    return all;
}

void expect_pooled(const std::filesystem::path& strips, const MadeEvidence& made) {
    const StripStore store(strips, test::strip_key, made.layout);
    EXPECT_EQ(test::counts_of(store), made.pooled());
    const RayTallies expected = made.tallies();
    EXPECT_EQ(store.tallies().rays, expected.rays);
    EXPECT_EQ(store.tallies().self, expected.self);
    EXPECT_EQ(store.tallies().open, expected.open);
    EXPECT_EQ(store.tallies().back, expected.back);
    EXPECT_EQ(store.pair_count(), made.pooled().size());
}

TEST(Pooling, EqualsPlainCounting) {
    for (const std::vector<std::uint32_t>& sizes :
         {std::vector<std::uint32_t>{1}, {2}, {40, 1, 30}, {5, 0, 7, 0}, {1, 1, 1, 1, 1, 1, 1, 1}, {200, 70}}) {
        const TemporaryFolder folder;
        const MadeEvidence made = test::random_evidence(sizes, 9, 3, static_cast<unsigned>(sizes.size()));
        expect_pooled(pool(folder, made, test::write_evidence(folder.path(), made.records, 1000, 64), "strips"), made);
    }
}

/// The same rays a second time: another file of the same name, an overlap of levels, a repeated record.
TEST(Pooling, RefusesTheSameRaysTwice) {
    MadeEvidence made;
    made.layout.first_patch = {0, 1, 2};
    made.ids = {7, 8};
    const EvidenceRecord first{7, 1, 0, 3, 0, 0, {8}, {8}};
    const auto refused = [&](const EvidenceRecord& second, bool other_file) -> std::string {
        const TemporaryFolder folder;
        made.records = {first, second};
        const auto files = test::write_evidence(folder.path(), made.records, other_file ? 1 : 2, 1);
        try {
            pool(folder, made, files, "strips");
        } catch (const Error& error) {
            EXPECT_EQ(error.code, ErrorCode::damaged_store);
            EXPECT_NE(error.where.find(files.back().string() + ": block " + (other_file ? "0" : "1")), std::string::npos) << error.where;
            EXPECT_FALSE(error.hint.empty());
            return error.what_text;
        }
        return {};
    };
    for (const bool other_file : {false, true}) {
        EXPECT_NE(refused(first, other_file).find("second time"), std::string::npos);
        EXPECT_NE(refused({7, 1, 3, 5, 0, 0, {8}, {28}}, other_file), "") << "overlap in level 3";
        EXPECT_NE(refused({7, 1, 0, 0, 1, 0, {}, {}}, other_file), "") << "overlap in level 0";
        EXPECT_EQ(refused({7, 1, 4, 5, 0, 0, {8}, {24}}, other_file), "") << "the next levels";
        EXPECT_EQ(refused({7, 0, 0, 3, 0, 0, {8}, {8}}, other_file), "") << "another replicate";
        EXPECT_EQ(refused({8, 1, 0, 3, 0, 0, {7}, {8}}, other_file), "") << "another patch";
        EXPECT_EQ(refused({7, 1, 31, 31, 0, 0, {8}, {1u << 30}}, other_file), "") << "the last level there is";
    }
}

TEST(Pooling, CountsAbove16Bits) {
    const TemporaryFolder folder;
    MadeEvidence made;
    made.layout.first_patch = {0, 1, 2};
    made.ids = {7, 8};
    made.records = {{7, 0, 0, 30, 0, 0, {8}, {1u << 30}},
                    {8, 0, 0, 20, 0, 3, {7, 8}, {65536 - 3, (1u << 20) - 65536}},
                    {8, 1, 0, 16, 0, 0, {7}, {65536}}};
    const auto strips = pool(folder, made, test::write_evidence(folder.path(), made.records, 2, 2), "strips");
    expect_pooled(strips, made);
    EXPECT_EQ(made.pooled().begin()->second, (1u << 30) + 2 * 65536u - 3);
}

TEST(Pooling, DoesNotDependOnTheCut) {
    const TemporaryFolder folder;
    MadeEvidence made = test::random_evidence({60, 30, 90}, 20, 4, 1);
    const auto files = test::write_evidence(folder.path(), made.records, 100000, 64);
    const auto expected = strip_bytes(pool(folder, made, files, "whole"), made.layout);
    // Every record a block of its own: those of one patch are read at the same time.
    const auto single = test::write_evidence(folder.path(), made.records, 100000, 1, "single");
    EXPECT_EQ(strip_bytes(pool(folder, made, single, "a"), made.layout), expected);
    const auto many = test::write_evidence(folder.path(), made.records, 7, 3, "many");
    EXPECT_EQ(strip_bytes(pool(folder, made, many, "b"), made.layout), expected);
    std::mt19937_64 random(2);
    std::shuffle(made.records.begin(), made.records.end(), random);
    const auto shuffled = test::write_evidence(folder.path(), made.records, 50, 13, "shuffled");
    EXPECT_EQ(strip_bytes(pool(folder, made, shuffled, "c"), made.layout), expected);
    expect_pooled(folder / "c", made);
}

/// More pairs than the smallest memory holds, most of them in one bucket: that is spilled, and sorted in several
/// passes.
TEST(Pooling, DoesNotDependOnMemoryOrThreads) {
    const TemporaryFolder folder;
    const MadeEvidence made = test::random_evidence({600, 300, 100, 200}, 200, 6, 3);
    // Buckets may hold half of 8 MiB, 8 bytes a pair; a pair is dealt once or twice.
    ASSERT_GT(made.pooled().size(), std::size_t{1} << 19);
    const auto files = test::write_evidence(folder.path(), made.records, 600, 64);
    const auto expected = strip_bytes(pool(folder, made, files, "large"), made.layout);
    for (const unsigned threads : {1u, 2u}) {
        const ThreadLimit limit(threads);
        const std::string name = "small" + std::to_string(threads);
        EXPECT_EQ(strip_bytes(pool(folder, made, files, name, 0), made.layout), expected);
    }
    for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
        EXPECT_EQ(entry.path().filename().string().find("pooling"), std::string::npos) << "the scratch file is left";
    expect_pooled(folder / "small1", made);
    // The proof that the small memory did not do: without a place for the scratch file it must fail.
    std::filesystem::create_directory(folder / "none");
    try {
        pool_evidence(made.layout, made.ids, test::keyed(files), folder / "none", test::strip_key,
                      {0, folder / "no such folder"}, {});
        FAIL() << "no scratch file was needed";
    } catch (const Error& error) {
        EXPECT_EQ(error.code, ErrorCode::cannot_write);
    }
}

TEST(Pooling, RunsOnlyWhenStripsAreMissing) {
    const TemporaryFolder folder;
    const MadeEvidence made = test::random_evidence({10, 10}, 5, 1, 4);
    const auto files = test::write_evidence(folder.path(), made.records, 1000, 64);
    const auto strips = pool(folder, made, files, "strips");
    const auto expected = strip_bytes(strips, made.layout);
    const auto again = [&] {
        return pool_evidence(made.layout, made.ids, test::keyed(files), strips, test::strip_key,
                             {0, folder.path()}, {});
    };
    EXPECT_FALSE(again());
    std::filesystem::remove(strip_path(strips, 1));
    EXPECT_TRUE(again());
    EXPECT_EQ(strip_bytes(strips, made.layout), expected);
    publish_file(strip_path(strips, 0), Bytes(expected[0].begin(), expected[0].end() - 1));
    EXPECT_TRUE(again());
    EXPECT_EQ(strip_bytes(strips, made.layout), expected);
}

ErrorCode code_of(const std::function<void()>& body) {
    try {
        body();
    } catch (const Error& error) {
        EXPECT_FALSE(error.hint.empty()) << error.what();
        return error.code;
    }
    return ErrorCode::internal;
}

TEST(Pooling, RefusesEvidenceOfAnotherScene) {
    const TemporaryFolder folder;
    const MadeEvidence made = test::random_evidence({10, 10}, 5, 1, 5);
    MadeEvidence other = made;
    const auto files = test::write_evidence(folder.path(), made.records, 1000, 64);
    for (const std::size_t missing : {0u, 7u, 19u}) {
        other.ids = made.ids;
        other.ids[missing] += 1;
        EXPECT_EQ(code_of([&] { pool(folder, other, files, "strips"); }), ErrorCode::damaged_store);
    }
    const Key other_key{1, 1};
    EXPECT_EQ(code_of([&] {
                  pool_evidence(made.layout, made.ids, test::keyed(files, other_key), folder / "strips", test::strip_key,
                                {0, folder.path()}, {});
              }),
              ErrorCode::damaged_store);
    EXPECT_FALSE(std::filesystem::exists(strip_path(folder / "strips", 0))) << "no strip of wrong evidence";
}

TEST(Pooling, RefusesDamagedEvidence) {
    const TemporaryFolder folder;
    const MadeEvidence made = test::random_evidence({6, 6}, 3, 1, 6);
    const auto files = test::write_evidence(folder.path(), made.records, 1000, 6);
    const Bytes whole = read_file(files[0]);
    for (std::size_t at = 0; at < whole.size(); at += 7) {
        Bytes bytes = whole;
        bytes[at] = static_cast<std::uint8_t>(bytes[at] ^ 0x10);
        publish_file(files[0], bytes);
        EXPECT_TRUE(test::refused({}, [&](ByteView) { pool(folder, made, files, "strips"); })) << "byte " << at;
    }
    std::filesystem::remove(files[0]);
    EXPECT_TRUE(test::refused({}, [&](ByteView) { pool(folder, made, files, "strips"); })) << "missing";
}

TEST(Pooling, RefusesMoreRaysThan32Bits) {
    const TemporaryFolder folder;
    MadeEvidence made;
    made.layout.first_patch = {0, 3};
    made.ids = {1, 2, 3};
    made.records = {{1, 0, 0, 31, 1u << 31, 0, {}, {}}, {1, 1, 0, 31, 1u << 31, 0, {}, {}}};
    EXPECT_TRUE(test::refused(
        {}, [&](ByteView) { pool(folder, made, test::write_evidence(folder.path(), made.records, 9, 9), "rays"); }));
    made.records = {{1, 0, 0, 31, 0, 0, {2}, {1u << 31}}, {2, 1, 0, 31, 0, 0, {1}, {1u << 31}}};
    EXPECT_TRUE(test::refused(
        {}, [&](ByteView) { pool(folder, made, test::write_evidence(folder.path(), made.records, 9, 9), "pairs"); }));
}

TEST(Pooling, RefusesTooManyChunks) {
    const TemporaryFolder folder;
    MadeEvidence made;
    for (PatchNumber p = 1; p <= 65537; ++p) made.layout.first_patch.push_back(p);
    made.ids.resize(65537);
    EXPECT_EQ(code_of([&] { pool(folder, made, {}, "strips"); }), ErrorCode::usage);
}

TEST(Pooling, ReportsProgressToTheEnd) {
    const TemporaryFolder folder;
    const MadeEvidence made = test::random_evidence({10, 10, 10}, 5, 1, 8);
    const auto files = test::write_evidence(folder.path(), made.records, 30, 64);
    std::filesystem::create_directory(folder / "strips");
    std::uint64_t last = 0, end = 0;
    pool_evidence(made.layout, made.ids, test::keyed(files), folder / "strips", test::strip_key,
                  {0, folder.path()}, [&](std::uint64_t done, std::uint64_t total) {
                      EXPECT_GT(done, last);
                      last = done, end = total;
                  });
    EXPECT_EQ(last, end);
    EXPECT_EQ(end, files.size() + 3);
}

}  // namespace
}  // namespace luxel
