// Whole bakes of scenes that let light through: energy, closed forms, the same bytes for any thread count, and what a bake
// folder does when only what passes has changed.
#include <gtest/gtest.h>

#include <cmath>

#include "baker/bake/bake_folder.h"
#include "baker/bake/geometry_stages.h"
#include "baker/bake/stage_clock.h"
#include "tests/bake/whole_bake.h"
#include "tests/support/temporary_folder.h"

namespace luxel::test {
namespace {

class SeeThroughSamples : public testing::TestWithParam<const char*> {};

TEST_P(SeeThroughSamples, EnergyIsKeptAndThreadsChangeNothing) {
    const TemporaryFolder folder;
    BakeOptions options = small_options(sample(GetParam()), {});
    options.tolerance = 1e-4;
    options.threads = 1;
    const FinishedBake one = bake_in(folder / "one", options);
    options.threads = 2;
    const FinishedBake two = bake_in(folder / "two", options);
    EXPECT_EQ(differences(one.outputs, two.outputs), "");
    EXPECT_EQ(differences(one.stored, two.stored), "");
    EXPECT_LE(energy_imbalance(one.report), 1e-3);
    for (const std::size_t c : {0u, 1u, 2u}) EXPECT_GT(one.report.emitted_lm[c], 0);
    EXPECT_TRUE(one.report.warnings.empty()) << one.report.warnings.front().text;
}

INSTANTIATE_TEST_SUITE_P(Samples, SeeThroughSamples, testing::Values("fence", "glass_room"));

/// The furnace with a level sheet of 1.6 x 1.6 m in its middle, two-sided, made of `material`.
std::filesystem::path furnace_with_sheet(const std::filesystem::path& folder, const nlohmann::json& material) {
    return edited_sample("furnace", folder, [&](nlohmann::json& document) {
        document["materials"].push_back(material);
        for (std::size_t n = 0; n < document["nodes"].size(); ++n) {
            if (document["nodes"][n]["name"] != "wall_plus_y") continue;
            nlohmann::json mesh = document["meshes"][document["nodes"][n]["mesh"].get<std::size_t>()];
            mesh["name"] = "sheet";
            mesh["primitives"][0]["material"] = document["materials"].size() - 1;
            document["meshes"].push_back(mesh);
            document["nodes"].push_back({{"name", "sheet"}, {"mesh", document["meshes"].size() - 1},
                                         {"scale", {0.8, 0.8, 0.8}}, {"translation", {0, -0.8, 0}}});
            document["scenes"][0]["nodes"].push_back(document["nodes"].size() - 1);
            return;
        }
    });
}

/// Every surface emits 1 lm/m2 of what is there of it and reflects a half: B = H = 2 on all, whatever passes where. Half a sheet of
/// two sides emits as a whole one of one side.
TEST(SeeThroughFurnaceBake, HalfASheetHasTheClosedForm) {
    const TemporaryFolder folder;
    const double nits = 1 / 3.14159265358979;
    BakeOptions options = small_options(furnace_with_sheet(folder / "scene", {{"name", "sheet"},
                                                                              {"doubleSided", true},
                                                                              {"alphaMode", "BLEND"},
                                                                              {"emissiveFactor", {nits, nits, nits}},
                                                                              {"pbrMetallicRoughness", {{"baseColorFactor", {0.5, 0.5, 0.5, 0.5}}, {"metallicFactor", 0.0}}}}),
                                        folder / "out.glb");
    options.tolerance = 1e-5;
    options.work = folder / "work";
    const BakeReport report = bake(options);
    for (const std::size_t c : {0u, 1u, 2u}) EXPECT_NEAR(report.emitted_lm[c], 24 + 2 * 0.5 * 2.56, 1e-3);
    EXPECT_LE(energy_imbalance(report), 1e-4);
    for (const Channels& radiosity : stored_solution(options.work, report.patches).radiosity)
        for (const double b : radiosity) ASSERT_NEAR(b, 2, 4e-3);
    // The mean: a texel's rays that meet the rim of the sheet may land where no patch is.
    double sum = 0;
    const std::vector<float> irradiance = stored_irradiance(options.work);
    for (const float h : irradiance) sum += static_cast<double>(h);
    EXPECT_NEAR(sum / static_cast<double>(irradiance.size()), 2, 4e-3);
}

/// A pane that tints takes light away: what it absorbs is in the balance, and a darker tint leaves less.
TEST(SeeThroughFurnaceBake, WhatPanesAbsorbIsLost) {
    const TemporaryFolder folder;
    double before = 48;  // lm absorbed on the walls: 24 m2 of B = 2, half of which they keep, and none of it lost
    for (const double tint : {1.0, 0.5, 0.1}) {
        const auto scene = furnace_with_sheet(folder / "scene", {{"name", "pane"},
                                                                 {"doubleSided", true},
                                                                 {"pbrMetallicRoughness", {{"baseColorFactor", {tint, tint, tint, 1.0}}, {"metallicFactor", 0.0}}},
                                                                 {"extensions", {{"KHR_materials_transmission", {{"transmissionFactor", 1.0}}}}}});
        BakeOptions options = small_options(scene, folder / "out.glb");
        options.tolerance = 1e-5;
        const BakeReport report = bake(options);
        EXPECT_LE(energy_imbalance(report), 1e-4);
        EXPECT_NEAR(report.emitted_lm[0], 24, 1e-3);
        // Rows of the closed walls lose nothing but to the pane.
        if (tint == 1) EXPECT_NEAR(report.lost_lm[0], 0, 0.05);
        else EXPECT_GT(report.lost_lm[0], 0.5);
        EXPECT_LT(report.absorbed_lm[0], before);
        before = report.absorbed_lm[0];
    }
}

TEST(SeeThroughBake, TheColourOfBlendingIsInTheKeys) {
    const TemporaryFolder folder;
    BakeOptions options = small_options(furnace_with_sheet(folder / "scene", {{"name", "sheet"},
                                                                              {"alphaMode", "BLEND"},
                                                                              {"pbrMetallicRoughness", {{"baseColorFactor", {1.0, 0.2, 0.2, 0.25}}, {"metallicFactor", 0.0}}}}),
                                        {});
    const FinishedBake plain = bake_in(folder / "plain", options);
    options.blend_colours = true;
    const FinishedBake coloured = bake_in(folder / "coloured", options);
    EXPECT_NE(plain.files("evidence").begin()->first, coloured.files("evidence").begin()->first);
    EXPECT_GT(plain.report.absorbed_lm[1], coloured.report.absorbed_lm[1]);
}

/// Mean irradiance of the room behind the pane, per channel.
std::array<double, 3> dark_room_light(const std::filesystem::path& folder, const std::array<double, 3>& tint, std::uint32_t gather_rays) {
    BakeOptions options = small_options(edited_sample("glass_room", folder / "scene", [&](nlohmann::json& document) {
                                            for (auto& material : document["materials"])
                                                if (material["name"] == "pane")
                                                    material["pbrMetallicRoughness"]["baseColorFactor"] = {tint[0], tint[1], tint[2], 1.0};
                                        }),
                                        folder / "out.glb");
    options.work = folder / "work";
    options.gather_rays = gather_rays;
    options.rays = 1024;
    bake(options);
    const BakeFolder bake_folder(options.work, options.output);
    BakeReport ignored;
    StageClock clock(options, ignored);
    const auto geometry = prepare_geometry(options, bake_folder, clock, ignored);
    const std::vector<float> irradiance = stored_irradiance(options.work);
    std::array<double, 3> sum{};
    std::size_t at = 0, count = 0;
    for (const PageTexels& page : geometry->texels.pages)
        for (const Texel& texel : page.texels) {
            const bool is_dark = geometry->scene.objects[geometry->atlas.charts[texel.chart].object].name.starts_with("/dark_room");
            count += is_dark;
            for (double& channel : sum) channel += is_dark ? static_cast<double>(irradiance[at]) : 0.0, ++at;
        }
    EXPECT_EQ(at, irradiance.size());
    for (double& channel : sum) channel /= static_cast<double>(count);
    return sum;
}

/// Channels know nothing of each other: what a tinted pane does to one is what a grey pane does to all, bounces of
/// light in the room behind it included.
TEST(SeeThroughBake, ChannelsAreWhatGreyPanesMakeOfThem) {
    const TemporaryFolder folder;
    const std::array<double, 3> tint{0.25, 0.8, 0.4};
    for (const std::uint32_t gather_rays : {0u, 16u}) {
        const std::filesystem::path here = folder / std::to_string(gather_rays);
        const auto tinted = dark_room_light(here / "tinted", tint, gather_rays);
        for (const std::size_t c : {0u, 1u, 2u}) {
            const auto grey = dark_room_light(here / std::to_string(c), {tint[c], tint[c], tint[c]}, gather_rays);
            EXPECT_NEAR(tinted[c] / grey[c], 1, 0.03) << "channel " << c << ", rays " << gather_rays;
        }
    }
}

}  // namespace
}  // namespace luxel::test
