// Whole bakes with settings of single nodes: what each of them does, and that saying nothing changes nothing. docs/settings.md.
#include <gtest/gtest.h>

#include <fstream>
#include <numeric>

#include "baker/bake/bake_folder.h"
#include "baker/bake/geometry_stages.h"
#include "baker/bake/stage_clock.h"
#include "formats/gltf/gltf_document.h"
#include "tests/bake/whole_bake.h"
#include "tests/support/temporary_folder.h"

namespace luxel::test {
namespace {

nlohmann::json& node_named(nlohmann::json& document, const std::string& name) {
    for (auto& node : document["nodes"])
        if (node["name"] == name) return node;
    throw std::runtime_error("no node " + name);
}

std::filesystem::path settings_file(const std::filesystem::path& folder, const nlohmann::json& entry) {
    std::filesystem::create_directories(folder);
    std::ofstream(folder / "luxel.json") << nlohmann::json({{"nodes", {entry}}}).dump();
    return folder / "luxel.json";
}

/// Irradiance of the texels of one node (red), in the order of its charts' texels; empty without a lightmap.
struct NodeLight {
    std::vector<float> red;
    [[nodiscard]] double mean() const {
        return std::accumulate(red.begin(), red.end(), 0.0, [](double sum, float h) { return sum + static_cast<double>(h); }) / static_cast<double>(red.size());
    }
};

/// Bakes in `folder`; light by node path.
std::map<std::string, NodeLight> light_by_node(const std::filesystem::path& folder, BakeOptions options, BakeReport* report = nullptr) {
    options.output = folder / "out/scene.glb";
    options.work = folder / "work";
    const BakeReport done = bake(options);
    if (report) *report = done;
    const BakeFolder bake_folder(options.work, options.output);
    BakeReport ignored;
    StageClock clock(options, ignored);
    const auto geometry = prepare_geometry(options, bake_folder, clock, ignored);
    const std::vector<float> irradiance = stored_irradiance(options.work);
    std::map<std::string, NodeLight> light;
    std::size_t at = 0;
    for (std::uint32_t page = 0; page < geometry->shown_pages; ++page)
        for (const Texel& texel : geometry->texels.pages[page].texels) {
            const std::string& name = geometry->scene.objects[geometry->atlas.charts[texel.chart].object].name;
            light[name.substr(0, name.find(','))].red.push_back(irradiance.at(at));
            at += 3;
        }
    EXPECT_EQ(at, irradiance.size());
    return light;
}

BakeOptions draft_options(const std::filesystem::path& input) {
    BakeOptions options = small_options(input, {});
    options.gather_rays = 0;
    options.tolerance = 1e-5;
    return options;
}

/// lamps_over_floor with a plate of 1.2 x 1.2 m below its lamps.
std::filesystem::path plate_over_floor(const std::filesystem::path& folder, const nlohmann::json& extras) {
    return edited_sample("lamps_over_floor", folder, [&](nlohmann::json& document) {
        nlohmann::json mesh = document["meshes"][node_named(document, "floor")["mesh"].get<std::size_t>()];
        mesh["name"] = "plate";
        document["meshes"].push_back(mesh);
        document["nodes"].push_back({{"name", "plate"}, {"mesh", document["meshes"].size() - 1}, {"scale", {0.2, 0.2, 0.2}},
                                     {"translation", {-1.2, 0.5, -0.8}}, {"extras", {{"luxel", extras}}}});
        document["scenes"][0]["nodes"].push_back(document["nodes"].size() - 1);
    });
}

TEST(SettingsBake, SayingNothingChangesNothing) {
    const TemporaryFolder folder;
    const FinishedBake plain = bake_in(folder / "plain", small_options(sample("furnace"), {}));
    BakeOptions options = small_options(edited_sample("furnace", folder / "scene", [](nlohmann::json& document) {
                                            for (auto& node : document["nodes"]) node["extras"]["luxel"] = nlohmann::json::object();
                                        }),
                                        {});
    options.settings = settings_file(folder / "settings", {{"match", "*"}, {"lightmap", true}, {"castShadow", true}, {"receive", true}});
    const FinishedBake same = bake_in(folder / "same", options);
    EXPECT_EQ(differences(plain.stored, same.stored), "");
    EXPECT_EQ(plain.outputs.at("scene.lightmap0.exr"), same.outputs.at("scene.lightmap0.exr"));
}

TEST(SettingsBake, WithoutShadowTheFloorIsLitAsIfNothingWereThere) {
    const TemporaryFolder folder;
    BakeOptions options = draft_options(sample("lamps_over_floor"));
    for (const std::uint32_t gather_rays : {0u, 16u}) {
        options.gather_rays = gather_rays;
        const std::filesystem::path here = folder / std::to_string(gather_rays);
        options.input = sample("lamps_over_floor");
        const auto bare = light_by_node(here / "bare", options);
        options.input = plate_over_floor(here / "scene", {{"castShadow", false}});
        const auto passed = light_by_node(here / "passed", options);
        options.input = plate_over_floor(here / "other", nlohmann::json::object());
        const auto shadowed = light_by_node(here / "shadowed", options);
        EXPECT_EQ(bare.at("/floor").red, passed.at("/floor").red);
        EXPECT_LT(shadowed.at("/floor").mean(), 0.95 * bare.at("/floor").mean());
        // Its own lightmap is what it was.
        ASSERT_EQ(passed.at("/plate").red.size(), shadowed.at("/plate").red.size());
        EXPECT_NEAR(passed.at("/plate").mean() / shadowed.at("/plate").mean(), 1, 1e-3);
    }
}

/// In a room of light, what casts no shadow gets the light of the room, and takes next to none of it.
TEST(SettingsBake, WithoutShadowNothingOfTheRoomsLightIsLost) {
    const TemporaryFolder folder;
    const auto scene = [&](const nlohmann::json& extras) {
        return edited_sample("furnace", folder / "scene", [&](nlohmann::json& document) {
            nlohmann::json mesh = document["meshes"][node_named(document, "wall_plus_y")["mesh"].get<std::size_t>()];
            document["materials"].push_back({{"pbrMetallicRoughness", {{"baseColorFactor", {0.1, 0.1, 0.1, 1.0}}, {"metallicFactor", 0.0}}}});
            mesh["primitives"][0]["material"] = document["materials"].size() - 1;
            document["meshes"].push_back(mesh);
            document["nodes"].push_back({{"name", "sheet"}, {"mesh", document["meshes"].size() - 1}, {"scale", {0.8, 0.8, 0.8}},
                                         {"translation", {0, -0.8, 0}}, {"extras", {{"luxel", extras}}}});
            document["scenes"][0]["nodes"].push_back(document["nodes"].size() - 1);
        });
    };
    for (const std::uint32_t gather_rays : {0u, 16u}) {
        BakeOptions options = draft_options(scene({{"castShadow", false}}));
        options.gather_rays = gather_rays;
        const auto light = light_by_node(folder / std::to_string(gather_rays), options);
        EXPECT_EQ(light.size(), 7u);
        for (const auto& [name, of_node] : light) EXPECT_NEAR(of_node.mean(), 2, 0.01) << name;  // H = B = 1 / (1 - 0.5)
    }
    BakeOptions options = draft_options(scene(nlohmann::json::object()));
    EXPECT_LT(light_by_node(folder / "shadow", options).at("/wall_plus_y").mean(), 1.9);
}

/// What the materials of a node in the output refer to.
bool has_lightmap(const std::filesystem::path& model, const std::string& name) {
    const GltfDocument document = load_gltf(model);
    for (const auto& node : document.json["nodes"]) {
        if (node["name"] != name) continue;
        const auto& primitive = document.json["meshes"][node["mesh"].get<std::size_t>()]["primitives"][0];
        const auto& material = document.json["materials"][primitive["material"].get<std::size_t>()];
        const bool has_map = material.contains("extensions") && material["extensions"].contains("MOZ_lightmap");
        EXPECT_EQ(has_map, primitive["attributes"].contains("TEXCOORD_1")) << name;
        return has_map;
    }
    ADD_FAILURE() << "no node " << name;
    return false;
}

TEST(SettingsBake, WithoutLightmapANodeStillReflects) {
    const TemporaryFolder folder;
    for (const std::uint32_t gather_rays : {0u, 16u}) {
        const std::filesystem::path here = folder / std::to_string(gather_rays);
        BakeOptions options = draft_options(sample("furnace"));
        options.gather_rays = gather_rays;
        const auto whole = light_by_node(here / "whole", options);
        options.settings = settings_file(here, {{"match", "wall_plus_y"}, {"lightmap", false}});
        BakeReport report;
        const auto parted = light_by_node(here / "parted", options, &report);
        EXPECT_EQ(parted.size(), 5u);
        EXPECT_FALSE(parted.contains("/wall_plus_y"));
        for (const auto& [name, light] : parted) EXPECT_NEAR(light.mean(), 2, 5e-3) << name;
        EXPECT_EQ(report.pages, lightmap_pages(report).size());
        EXPECT_EQ(stored_irradiance(here / "parted/work").size() / 3 + whole.at("/wall_plus_y").red.size(),
                  stored_irradiance(here / "whole/work").size() / 3);
        EXPECT_FALSE(has_lightmap(here / "parted/out/scene.glb", "wall_plus_y"));
        EXPECT_TRUE(has_lightmap(here / "parted/out/scene.glb", "wall_minus_y"));
    }
}

/// A node that receives nothing is a black one that emits what it did.
TEST(SettingsBake, WhatReceivesNoLightIsBlack) {
    const TemporaryFolder folder;
    BakeOptions options = draft_options(edited_sample("furnace", folder / "scene", [](nlohmann::json& document) {
        nlohmann::json black = document["materials"][0];
        black["name"] = "black";
        black["pbrMetallicRoughness"]["baseColorFactor"] = {0, 0, 0, 1};
        document["materials"].push_back(black);
        document["meshes"][node_named(document, "wall_plus_y")["mesh"].get<std::size_t>()]["primitives"][0]["material"] = 1;
    }));
    const auto black = light_by_node(folder / "black", options);
    options.input = sample("furnace");
    options.settings = settings_file(folder / "settings", {{"match", "wall_plus_y"}, {"receive", false}});
    const auto deaf = light_by_node(folder / "deaf", options);
    EXPECT_FALSE(deaf.contains("/wall_plus_y"));
    for (const auto& [name, light] : deaf) EXPECT_NEAR(light.mean() / black.at(name).mean(), 1, 2e-3) << name;
    EXPECT_LT(deaf.at("/wall_minus_y").mean(), 1.9);
    EXPECT_FALSE(has_lightmap(folder / "deaf/out/scene.glb", "wall_plus_y"));
}

TEST(SettingsBake, DensityOfANode) {
    const TemporaryFolder folder;
    BakeOptions options = draft_options(sample("furnace"));
    const auto even = light_by_node(folder / "even", options);
    options.settings = settings_file(folder / "settings", {{"match", "wall_plus_y"}, {"texelsPerMetre", 8}});
    const auto finer = light_by_node(folder / "finer", options);
    EXPECT_EQ(even.at("/wall_plus_y").red.size(), 64u);
    EXPECT_EQ(finer.at("/wall_plus_y").red.size(), 256u);
    EXPECT_EQ(finer.at("/wall_minus_y").red.size(), 64u);
    for (const auto& [name, light] : finer) EXPECT_NEAR(light.mean(), 2, 2e-3) << name;
}

TEST(SettingsBake, OfANodeWithoutLightmapReceiveIsOnlyLight) {
    const TemporaryFolder folder;
    BakeOptions options = draft_options(sample("furnace"));
    options.output = folder / "out/scene.glb";
    options.work = folder / "work";
    options.settings = settings_file(folder / "settings", {{"match", "wall_plus_y"}, {"lightmap", false}});
    bake(options);
    options.settings = settings_file(folder / "settings", {{"match", "wall_plus_y"}, {"lightmap", false}, {"receive", false}});
    for (const StageReport& stage : bake(options).stages) {
        const bool is_kept = stage.name == "unwrap" || stage.name == "evidence" || stage.name == "pooling";
        if (is_kept || stage.name == "solve" || stage.name == "light") {
            EXPECT_EQ(stage.reused, is_kept) << stage.name;
        }
    }
}

TEST(SettingsBake, ABakeOfNothingIsRefused) {
    const TemporaryFolder folder;
    BakeOptions options = draft_options(sample("furnace"));
    options.output = folder / "out/scene.glb";
    options.settings = settings_file(folder / "settings", {{"match", "*"}, {"lightmap", false}});
    try {
        bake(options);
        ADD_FAILURE() << "nothing was thrown";
    } catch (const Error& error) {
        EXPECT_EQ(error.code, ErrorCode::bad_input);
        EXPECT_NE(error.what_text.find("no node has a lightmap"), std::string::npos);
    }
    options.settings = folder / "gone.json";
    EXPECT_THROW(bake(options), Error);
}

}  // namespace
}  // namespace luxel::test
