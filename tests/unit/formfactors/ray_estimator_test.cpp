/// Evidence is a pure function of geometry, stable id, options and levels; levels add up; files say the same as
/// records.
#include "baker/formfactors/ray_estimator.h"

#include <gtest/gtest.h>

#include <random>

#include "baker/formfactors/evidence.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/formfactors/made_evidence_scene.h"

namespace luxel {
namespace {

using test::Prepared;
using test::SceneMaker;

std::unique_ptr<Prepared> furnished(std::uint32_t chunk_patches = 100) {
    SceneMaker maker;
    return test::prepare(test::add_furnished_room(maker, "room", Vec3d(0, 0, 0)).build(),
                         {.chunk_patches = chunk_patches});
}

TEST(RayEstimator, EveryRayEndsSomewhere) {
    const auto made = furnished();
    ASSERT_GT(made->patches.count(), 200u);
    const auto ids = made->ids();
    for (const auto& [id, records] : test::evidence_of(*made, *test::estimator_of(*made), {0, 7})) {
        ASSERT_EQ(records.size(), 4u);
        for (std::size_t replicate = 0; replicate < 4; ++replicate) {
            const EvidenceRecord& record = records[replicate];
            EXPECT_EQ(record.patch_id, id);
            EXPECT_EQ(record.replicate, replicate);
            EXPECT_EQ(record.ray_count(), 128u);
            EXPECT_EQ(record.open, 0u) << "the room is closed";
            // The decoder checks order and sums.
            const EvidenceBlock block = decode_evidence(encode_evidence({&record, 1}), "record");
            EXPECT_EQ(record_of(block, 0), record);
            for (const PatchId target : record.target_id) EXPECT_TRUE(std::ranges::find(ids, target) != ids.end());
        }
    }
}

TEST(RayEstimator, DoesNotDependOnNumbersOrChunks) {
    const auto made = furnished();
    const auto expected = test::evidence_of(*made, *test::estimator_of(*made), {0, 6});
    std::mt19937_64 random(1);
    for (int round = 0; round < 3; ++round) {
        std::vector<PatchNumber> numbers(made->patches.count());
        for (PatchNumber p = 0; p < numbers.size(); ++p) numbers[p] = p;
        std::shuffle(numbers.begin(), numbers.end(), random);
        renumber(made->patches, numbers);
        EXPECT_EQ(test::evidence_of(*made, *test::estimator_of(*made), {0, 6}), expected);
    }
    const auto other = furnished(37);
    EXPECT_NE(other->ids(), furnished()->ids()) << "numbers must differ for this to mean anything";
    EXPECT_EQ(test::evidence_of(*other, *test::estimator_of(*other), {0, 6}), expected);
}

EvidenceRecord merged(const EvidenceRecord& a, const EvidenceRecord& b) {
    std::map<std::uint64_t, std::uint32_t> counts;
    for (const EvidenceRecord* record : {&a, &b})
        for (std::size_t k = 0; k < record->count.size(); ++k) counts[record->target_id[k]] += record->count[k];
    EvidenceRecord sum{a.patch_id, a.replicate, a.first_level, b.last_level, a.open + b.open, a.back + b.back, {}, {}};
    for (const auto& [id, count] : counts) sum.target_id.push_back(id), sum.count.push_back(count);
    return sum;
}

TEST(RayEstimator, LevelsAddUp) {
    const auto made = furnished();
    const auto estimator = test::estimator_of(*made);
    const auto ids = made->ids();
    const auto collect = [&](PatchNumber patch, LevelRange levels) {
        std::vector<EvidenceRecord> records;
        collect_records(*estimator, ids, patch, levels, records);
        return records;
    };
    constexpr std::uint8_t last = 9;
    for (PatchNumber patch = 0; patch < made->patches.count(); patch += 17) {
        const auto whole = collect(patch, {0, last});
        for (std::uint8_t middle = 0; middle < last; ++middle) {
            const auto low = collect(patch, {0, middle});
            const auto high = collect(patch, {static_cast<std::uint8_t>(middle + 1), last});
            for (std::size_t r = 0; r < whole.size(); ++r)
                EXPECT_EQ(merged(low[r], high[r]), whole[r]) << "level " << +middle;
        }
    }
}

TEST(RayEstimator, SeedAndReplicatesMatter) {
    const auto made = furnished();
    const auto first = test::evidence_of(*made, *test::estimator_of(*made), {0, 5});
    EXPECT_NE(test::evidence_of(*made, *test::estimator_of(*made, {1, 4}), {0, 5}), first);
    // More replicates leave the first ones as they are.
    const auto more = test::evidence_of(*made, *test::estimator_of(*made, {0, 6}), {0, 5});
    std::size_t equal_replicates = 0;
    for (const auto& [id, records] : first) {
        EXPECT_TRUE(std::equal(records.begin(), records.end(), more.at(id).begin()));
        equal_replicates += records[0].target_id == records[1].target_id && records[0].count == records[1].count;
    }
    EXPECT_LT(equal_replicates, first.size() / 20) << "replicates are independent";
    const Key key = test::estimator_of(*made)->identity();
    EXPECT_NE(test::estimator_of(*made, {1, 4})->identity(), key);
    EXPECT_NE(test::estimator_of(*made, {0, 6})->identity(), key);
    EXPECT_EQ(test::estimator_of(*furnished())->identity(), key);
}

/// Bytes of the evidence files of all chunks.
std::vector<Bytes> files_of(const Prepared& made, const LevelPlan& plan, const std::filesystem::path& folder) {
    const auto estimator = test::estimator_of(made);
    const auto ids = made.ids();
    std::vector<Bytes> files;
    for (ChunkNumber c = 0; c < made.layout.chunk_count(); ++c) {
        Publisher publisher;
        write_chunk_evidence(*estimator, made.layout, ids, c, plan, folder / "evidence", {1, 2}, publisher, nullptr);
        publisher.finish();
        files.push_back(read_file(folder / "evidence"));
    }
    return files;
}

TEST(Evidence, SameFilesForAnyThreads) {
    const test::TemporaryFolder folder;
    const auto made = furnished();
    const LevelPlan plan = uniform_plan(made->patches.count(), 4, 256);
    std::vector<std::vector<Bytes>> found;
    for (const unsigned threads : {1u, 2u, 5u}) {
        const ThreadLimit limit(threads);
        found.push_back(files_of(*made, plan, folder.path()));
    }
    EXPECT_EQ(found[0], found[1]);
    EXPECT_EQ(found[0], found[2]);
    EXPECT_GT(found[0].size(), 2u);
}

TEST(Evidence, FilesSayTheSameAsRecords) {
    const test::TemporaryFolder folder;
    const auto made = furnished(150);
    const auto estimator = test::estimator_of(*made);
    const auto ids = made->ids();
    LevelPlan plan = uniform_plan(ids.size(), 4, 64);
    for (PatchNumber p = 0; p < ids.size(); p += 3) plan.levels[p] = {3, 8};  // a plan by importance
    std::uint64_t reported = 0;
    for (ChunkNumber c = 0; c < made->layout.chunk_count(); ++c) {
        ProgressCounter progress(1, [&](std::uint64_t done, std::uint64_t) { reported = done; });
        const auto path = folder / ("chunk" + std::to_string(c));
        Publisher publisher;
        write_chunk_evidence(*estimator, made->layout, ids, c, plan, path, {1, 2}, publisher, &progress);
        publisher.finish();
        EXPECT_EQ(reported, planned_rays(plan, 4, made->layout.first_patch[c], made->layout.first_patch[c + 1]));
        const BlockFileReader file(path, FileKind::evidence, evidence_version);
        std::vector<EvidenceRecord> expected;
        for (PatchNumber p = made->layout.first_patch[c]; p < made->layout.first_patch[c + 1]; ++p)
            collect_records(*estimator, ids, p, plan.levels[p], expected);
        std::size_t record = 0;
        for (std::size_t k = 0; k < file.blocks().size(); ++k) {
            EXPECT_EQ(file.blocks()[k].tag, record);
            const EvidenceBlock block = decode_evidence(file.read(k), "block");
            for (std::size_t row = 0; row < block.rows.size(); ++row, ++record) {
                ASSERT_LT(record, expected.size());
                EXPECT_EQ(record_of(block, row), expected[record]);
            }
        }
        EXPECT_EQ(record, expected.size());
    }
}

TEST(Evidence, UniformPlanRoundsUpToPowersOfTwo) {
    for (const std::uint64_t rays : {0ULL, 1ULL, 4ULL, 5ULL, 1000ULL, 1024ULL, 1025ULL}) {
        const LevelPlan plan = uniform_plan(3, 4, rays);
        ASSERT_EQ(plan.levels.size(), 3u);
        const std::uint64_t each = 4 * ray_count(plan.levels[0]);
        EXPECT_GE(each, rays);
        EXPECT_LE(each, std::max<std::uint64_t>(4, 2 * rays));
        EXPECT_EQ(planned_rays(plan, 4, 0, 3), 3 * each);
        EXPECT_EQ(planned_rays(plan, 4, 1, 2), each);
    }
    EXPECT_EQ(ray_count({0, 0}), 1u);
    EXPECT_EQ(ray_count({3, 5}), 28u);
}

}  // namespace
}  // namespace luxel
