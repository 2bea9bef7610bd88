// Seams in whole bakes: the sphere's charts meet, the report says how well, and nothing but pages depends on it.
#include <gtest/gtest.h>

#include "tests/bake/whole_bake.h"
#include "tests/support/temporary_folder.h"

namespace luxel::test {
namespace {

/// The sphere with a lamp off its middle: light that is not the same everywhere.
BakeOptions sphere_options(const TemporaryFolder& folder) {
    const auto scene = edited_sample("sphere", folder / "scene", [](nlohmann::json& gltf) {
        gltf["extensionsUsed"].push_back("KHR_lights_punctual");
        gltf["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}, {"intensity", 1.0}}};
        gltf["scenes"][0]["nodes"].push_back(gltf["nodes"].size());
        gltf["nodes"].push_back(
            {{"translation", {0.4, 0.2, 0.3}}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
    });
    BakeOptions options = small_options(scene, {});
    options.unwrap.texels_per_metre = 0;
    options.unwrap.page_size = 64;
    options.unwrap.padding = 1;
    return options;
}

TEST(SeamsBake, JoiningChangesThePagesAndNothingThatIsStored) {
    const TemporaryFolder folder;
    BakeOptions options = sphere_options(folder);
    options.seams = SeamMode::keep;
    const FinishedBake kept = bake_in(folder / "kept", options);
    options.seams = SeamMode::join;
    const FinishedBake joined = bake_in(folder / "joined", options);
    EXPECT_EQ(differences(kept.stored, joined.stored), "");
    EXPECT_NE(differences(kept.outputs, joined.outputs), "");
    EXPECT_FALSE(kept.report.seams.joined);
    EXPECT_EQ(kept.report.seams.points, 0u);

    const SeamReport& seams = joined.report.seams;
    EXPECT_TRUE(seams.joined);
    EXPECT_GT(seams.points, 100u);
    EXPECT_EQ(seams.blocked + seams.hidden, 0u) << "nothing stands inside the sphere";
    EXPECT_GT(seams.jump_before, 0.002);
    EXPECT_LT(seams.jump_after, seams.jump_before / 5);
    EXPECT_GT(seams.texels, 0u);

    // As many texels differ as the report says, and all of them stay light.
    const auto before = lightmap_pages(kept.report), after = lightmap_pages(joined.report);
    ASSERT_EQ(before.size(), after.size());
    std::uint64_t different = 0;
    for (std::size_t page = 0; page < before.size(); ++page)
        for (std::size_t t = 0; t < before[page].pixels.size(); ++t) {
            different += before[page].pixels[t] != after[page].pixels[t];
            for (std::size_t c = 0; c < 3; ++c) EXPECT_GE(after[page].pixels[t][c], 0);
        }
    EXPECT_GT(different, 0u);
    EXPECT_LE(different, seams.texels);
}

TEST(SeamsBake, ACreaseIsNoSeam) {
    const TemporaryFolder folder;
    BakeOptions options = small_options(sample("furnace"), {});
    const FinishedBake joined = bake_in(folder / "joined", options);
    options.seams = SeamMode::keep;
    const FinishedBake kept = bake_in(folder / "kept", options);
    EXPECT_EQ(joined.report.seams.seams, 0u) << "a box inside";
    EXPECT_EQ(differences(kept.outputs, joined.outputs), "");
}

TEST(SeamsBake, SeveralPagesAreJoinedAlikeForAnyThreadsAndMemory) {
    const TemporaryFolder folder;
    BakeOptions options = sphere_options(folder);
    options.unwrap.texels_per_metre = 16;
    options.unwrap.page_size = 32;
    options.threads = 1;
    const FinishedBake one = bake_in(folder / "one", options);
    ASSERT_GT(one.report.pages, 2u);
    EXPECT_GT(one.report.seams.jump_before, 0.005) << "finer texels, smaller jumps";
    EXPECT_LT(one.report.seams.jump_after, one.report.seams.jump_before / 5);
    options.threads = 3;
    options.output = folder / "probe.glb";
    options.memory_bytes = smallest_memory(options) + (std::uint64_t{4} << 20);
    const FinishedBake other = bake_in(folder / "other", options);
    EXPECT_EQ(differences(one.outputs, other.outputs), "");
}

}  // namespace
}  // namespace luxel::test
