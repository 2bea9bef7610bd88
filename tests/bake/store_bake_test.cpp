// --store all, hot and none: other bytes on the disk, the same bytes as result.
#include <gtest/gtest.h>

#include "tests/bake/whole_bake.h"
#include "tests/support/temporary_folder.h"

namespace luxel::test {
namespace {

BakeOptions with_store(BakeOptions options, StoreKind store, std::uint64_t bytes = 0) {
    options.store = store;
    options.store_bytes = bytes;
    return options;
}

void expect_same_result(const FinishedBake& expected, const FinishedBake& found) {
    EXPECT_GE(expected.outputs.size(), 3u);  // model, sidecar, pages
    EXPECT_EQ(differences(expected.outputs, found.outputs), "");
    for (const char* stem : {"atlas-", "plan-", "patches-", "closure-", "solution-", "accuracy-", "lightmaps-"})
        EXPECT_EQ(differences(expected.files(stem), found.files(stem)), "") << stem;
    EXPECT_EQ(found.report.pairs, expected.report.pairs);
    EXPECT_EQ(found.report.blocks, expected.report.blocks);
    EXPECT_EQ(found.report.evidence_rays, expected.report.evidence_rays);
    EXPECT_EQ(found.report.standard_error, expected.report.standard_error);
}

/// What is traced more than once depends on memory alone: enough for all rows, or for none of them.
void expect_stores_agree(const BakeOptions& options) {
    const TemporaryFolder folder;
    const FinishedBake all = bake_in(folder / "all", options);
    EXPECT_EQ(all.report.rays_traced, all.report.evidence_rays);
    EXPECT_GT(all.files("evidence-").size(), 1u);
    for (const unsigned threads : {1u, 2u}) {
        SCOPED_TRACE(std::to_string(threads) + " threads");
        const auto place = [&](const char* name) { return folder / (name + std::to_string(threads)); };
        BakeOptions other = options;
        other.threads = threads;
        const FinishedBake none = bake_in(place("none"), with_store(other, StoreKind::no_blocks));
        expect_same_result(all, none);
        for (const char* stem : {"evidence-", "strips-", "hot-"}) EXPECT_EQ(none.files(stem).size(), 0u) << stem;
        EXPECT_EQ(none.files("directory-").size(), 1u);
        EXPECT_GT(none.report.rays_traced, none.report.evidence_rays);
        EXPECT_LT(none.report.store_bytes, all.report.store_bytes / 4);

        const FinishedBake hot = bake_in(place("hot"), with_store(other, StoreKind::hot));
        expect_same_result(all, hot);
        for (const char* stem : {"evidence-", "strips-"}) EXPECT_EQ(hot.files(stem).size(), 0u) << stem;
        EXPECT_EQ(hot.files("hot-").size(), hot.report.chunks);
        EXPECT_EQ(hot.files("directory-").size(), 1u);
        EXPECT_GT(hot.report.store_bytes, none.report.store_bytes);
        EXPECT_LT(hot.report.store_bytes, all.report.store_bytes);
    }
}

TEST(StoreBake, DraftIsTheSameForAllStores) {
    BakeOptions options = small_options(sample("two_rooms"), {});
    options.gather_rays = 0;
    expect_stores_agree(options);
}

TEST(StoreBake, GatheredIsTheSameForAllStores) { expect_stores_agree(small_options(sample("two_rooms"), {})); }

TEST(StoreBake, AWantedErrorIsTheSameForAllStores) {
    BakeOptions options = small_options(sample("two_rooms"), {});
    options.error = 0.2;
    expect_stores_agree(options);
}

TEST(StoreBake, HemicubeIsTheSameForAllStores) {
    BakeOptions options = small_options(sample("cornell_box"), {});
    options.estimator = EstimatorKind::hemicube;
    options.hemicube_resolution = 16;
    const TemporaryFolder folder;
    const FinishedBake all = bake_in(folder / "all", options);
    expect_same_result(all, bake_in(folder / "none", with_store(options, StoreKind::no_blocks)));
    expect_same_result(all, bake_in(folder / "hot", with_store(options, StoreKind::hot)));
}

/// The smallest memory: hardly any row stays, so most is traced again; the same bytes.
TEST(StoreBake, LittleMemoryTracesMoreForTheSameResult) {
    const TemporaryFolder folder;
    BakeOptions options = with_store(small_options(sample("two_rooms"), folder / "probe.glb"), StoreKind::no_blocks);
    options.chunk_patches = 512;
    options.memory_bytes = std::uint64_t{4} << 30;
    const FinishedBake much = bake_in(folder / "much", options);
    options.memory_bytes = smallest_memory(options);
    const FinishedBake little = bake_in(folder / "little", options);
    EXPECT_EQ(differences(much.outputs, little.outputs), "");
    EXPECT_EQ(differences(much.files("directory-"), little.files("directory-")), "");
    EXPECT_GE(little.report.rays_traced, much.report.rays_traced);
}

/// One folder, one choice after the other: each leaves what it keeps and nothing of the others.
TEST(StoreBake, ChoicesMayFollowEachOther) {
    const TemporaryFolder folder;
    const BakeOptions options = small_options(sample("two_rooms"), {});
    const auto place = folder / "one";
    const FinishedBake all = bake_in(place, options);
    std::uint64_t blocks = 0;
    for (const auto& [name, bytes] : all.files("strips-")) blocks += bytes.size();
    const std::vector<BakeOptions> choices{with_store(options, StoreKind::no_blocks),          with_store(options, StoreKind::hot, blocks / 2),
                                           with_store(options, StoreKind::hot, blocks / 8),    with_store(options, StoreKind::no_blocks),
                                           with_store(options, StoreKind::hot),                options};
    for (std::size_t k = 0; k < choices.size(); ++k) {
        SCOPED_TRACE("choice " + std::to_string(k));
        const FinishedBake next = bake_in(place, choices[k]);
        expect_same_result(all, next);
        std::uint64_t kept = 0;
        for (const auto& [name, bytes] : next.files("hot-")) kept += bytes.size();
        if (choices[k].store != StoreKind::hot) {
            EXPECT_EQ(kept, 0u);
        } else {
            EXPECT_GT(kept, 0u);
        }
        if (choices[k].store_bytes) {
            // Tallies and the frames of the files come on top: a kilobyte or two for each.
            EXPECT_LT(kept, choices[k].store_bytes + next.report.chunks * 4096);
        }
        EXPECT_EQ(next.files("strips-").empty(), choices[k].store != StoreKind::all);
        EXPECT_EQ(next.files("directory-").empty(), choices[k].store == StoreKind::all);
    }
    // The last one is what a bake that never was another has.
    EXPECT_EQ(differences(all.stored, files_below(place / "work")), "");
}

/// What is in the folder is not traced again: a second bake reads everything, a relight only solves.
TEST(StoreBake, ASecondBakeTracesNothing) {
    for (const StoreKind store : {StoreKind::all, StoreKind::hot, StoreKind::no_blocks}) {
        const TemporaryFolder folder;
        const BakeOptions options = with_store(small_options(sample("two_rooms"), {}), store);
        const FinishedBake first = bake_in(folder.path(), options), second = bake_in(folder.path(), options);
        EXPECT_EQ(differences(first.stored, second.stored), "");
        EXPECT_EQ(differences(first.outputs, second.outputs), "");
        EXPECT_EQ(second.report.rays_traced, 0u) << store_name(store);
    }
}

}  // namespace
}  // namespace luxel::test
