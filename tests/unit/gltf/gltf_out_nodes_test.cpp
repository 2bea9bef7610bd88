// Lightmaps that nodes name, by MX_lightmap: places, pages, shared meshes, and what becomes of lightmaps of before.
#include "formats/gltf/gltf_out_nodes.h"

#include <gtest/gtest.h>

#include "tests/unit/gltf/made_gltf_out.h"

namespace luxel {
namespace {

class GltfOutNodes : public GltfOut {
  protected:
    /// Lightmaps with nodes as their place.
    static GltfLightmaps on_nodes(const SceneRecord& record, std::size_t pages = 1) {
        GltfLightmaps maps = lightmaps(record, pages);
        maps.meaning.placement = LightmapPlacement::nodes;
        maps.meaning.encoding = "rgbm8-mx", maps.meaning.format = "rgbm-mx", maps.meaning.profile = "mx", maps.meaning.range = 34.49;
        maps.meaning.lit_scale = maps.meaning.unlit_scale = 0.25;
        return maps;
    }
    /// A quad that several nodes show.
    static Model shared_quad(std::size_t nodes) {
        Model model;
        model.root["materials"] = json::array({{{"name", "wood"}}});
        model.root["meshes"] = json::array({{{"name", "chair"}, {"primitives", json::array({model.quad()})}}});
        for (std::size_t k = 0; k < nodes; ++k) model.show(0, ("chair " + std::to_string(k)).c_str());
        return model;
    }
    static const json& extension(const GltfDocument& out, std::size_t node) { return out.json["nodes"][node]["extensions"]["MX_lightmap"]; }
    static std::string page_name(const GltfDocument& out, std::size_t node) {
        return out.json["textures"][extension(out, node)["lightMapTexture"]["index"].get<std::size_t>()]["name"];
    }
};

TEST_F(GltfOutNodes, TheNodeSaysItAndTheMaterialStays) {
    const GltfDocument document = shared_quad(1).parse();
    const SceneRecord record = read_scene(document);
    GltfLightmaps maps = on_nodes(record);
    maps.instances[0] = laid_out({scattered(record.meshes[0].primitives[0])});
    const GltfDocument out = write_and_load(document, record, maps);
    EXPECT_EQ(out.json["materials"], document.json["materials"]);
    EXPECT_EQ(out.json["meshes"].size(), 1u);
    EXPECT_EQ(out.json["meshes"][0]["primitives"][0]["material"], 0);
    EXPECT_EQ(extension(out, 0), (json{{"lightMapTexture", {{"index", 0}, {"texCoord", 1}}},
                                       {"intensity", 0.625},
                                       {"extras", {{"quantity", "irradiance"}, {"unit", "lux"}, {"encoding", "rgbm8-mx"}, {"format", "rgbm-mx"},
                                                   {"profile", "mx"}, {"irradianceFactor", 4.0}, {"range", 34.49}}}}));
    EXPECT_EQ(out.json["extensionsUsed"], json{"MX_lightmap"});
    EXPECT_FALSE(out.json.contains("extensionsRequired"));
    EXPECT_EQ(corners(read_primitive(out, 0, 0), "TEXCOORD_1"), bytes_of_uv(scattered(record.meshes[0].primitives[0])));
}

TEST_F(GltfOutNodes, CopiesShareTheMeshAndDifferByTheirPlace) {
    const GltfDocument document = shared_quad(3).parse();
    const SceneRecord record = read_scene(document);
    GltfLightmaps maps = on_nodes(record, 2);
    PrimitiveLayout other_page = welded(record.meshes[0].primitives[0]);
    other_page.triangle_page.assign(other_page.triangle_page.size(), 1);
    maps.instances[0] = laid_out({welded(record.meshes[0].primitives[0])}, {{0.25f, 0.5f}, {0.125f, 0}});
    maps.instances[1] = {maps.instances[0].mesh, {{0.25f, 0.5f}, {0.5f, 0.25f}}};
    maps.instances[2] = laid_out({other_page}, {{0.25f, 0.5f}, {0, 0}});
    const GltfDocument out = write_and_load(document, record, maps);
    EXPECT_EQ(out.json["meshes"].size(), 2u) << "one per layout";
    EXPECT_EQ(out.json["nodes"][0]["mesh"], out.json["nodes"][1]["mesh"]);
    EXPECT_EQ(extension(out, 0)["scale"], (json{0.25, 0.5}));
    EXPECT_EQ(extension(out, 0)["offset"], (json{0.125, 0.0}));
    EXPECT_EQ(extension(out, 1)["offset"], (json{0.5, 0.25}));
    EXPECT_EQ(page_name(out, 1), "lightmap0");
    EXPECT_EQ(page_name(out, 2), "lightmap1");
    EXPECT_EQ(extension(out, 2)["intensity"], 0.875);
    EXPECT_EQ(out.json["extensionsUsed"], json{"MX_lightmap"}) << "and no KHR_texture_transform";
    EXPECT_EQ(out.json["materials"].size(), 1u);
}

TEST_F(GltfOutNodes, AMeshOnSeveralPagesBecomesChildren) {
    Model model;
    model.root["materials"] = json::array({json::object(), {{"name", "second"}}});
    json lines = model.quad(0), moved = model.quad(1);
    lines["mode"] = 1;
    const std::size_t lift = model.floats("VEC3", 3, {0, 0, 1, 0, 0, 2, 0, 0, 3, 0, 0, 4});
    json morphed = model.quad(0);
    for (json* primitive : {&morphed, &moved, &lines}) (*primitive)["targets"] = json::array({{{"POSITION", lift}}});
    model.root["meshes"] = json::array({{{"name", "hall"}, {"weights", {0.5}}, {"primitives", json::array({morphed, moved, lines})}}});
    model.show(0, "hall");
    model.root["nodes"][0]["weights"] = {0.25};
    const std::size_t times = model.floats("SCALAR", 1, {0, 1}), weights = model.floats("SCALAR", 1, {0, 1});
    model.root["animations"] = json::array({{{"samplers", json::array({{{"input", times}, {"output", weights}}})},
                                             {"channels", json::array({{{"sampler", 0}, {"target", {{"node", 0}, {"path", "weights"}}}}})}}});
    const GltfDocument document = model.parse();
    const SceneRecord record = read_scene(document);
    GltfLightmaps maps = on_nodes(record, 2);
    const auto& primitives = record.meshes[0].primitives;
    maps.instances[0] = laid_out({scattered(primitives[0], [](std::size_t t) { return t == 0 ? 1u : 0u; }),
                                  scattered(primitives[1], [](std::size_t) { return 1u; })});
    const GltfDocument out = write_and_load(document, record, maps);
    ASSERT_EQ(out.json["nodes"].size(), 2u);
    EXPECT_EQ(out.json["nodes"][0]["children"], json{1});
    const json& child = out.json["nodes"][1];
    EXPECT_EQ(child["name"], "hall (lightmap part 1)");
    EXPECT_EQ(child["weights"], json{0.25});
    EXPECT_FALSE(child.contains("translation"));
    EXPECT_EQ(page_name(out, 0), "lightmap0");
    EXPECT_EQ(page_name(out, 1), "lightmap1");
    const json& first = out.json["meshes"][out.json["nodes"][0]["mesh"].get<std::size_t>()];
    const json& second = out.json["meshes"][child["mesh"].get<std::size_t>()];
    ASSERT_EQ(first["primitives"].size(), 2u) << "a part, and lines, which have no page";
    EXPECT_EQ(first["primitives"][1]["mode"], 1);
    ASSERT_EQ(second["primitives"].size(), 2u);
    EXPECT_EQ(second["primitives"][0]["material"], 0);
    EXPECT_EQ(second["primitives"][1]["material"], 1);
    EXPECT_EQ(second["weights"], json{0.5});
    ASSERT_EQ(written.warnings.size(), 1u);
    EXPECT_EQ(written.warnings[0].code, "part-not-animated");
    std::size_t triangles = 0;
    for (const auto& [mesh, primitive] : {std::pair{0, 0}, std::pair{1, 0}, std::pair{1, 1}})
        triangles += read_primitive(out, out.json["nodes"][static_cast<std::size_t>(mesh)]["mesh"].get<std::int64_t>(), primitive).indices.size() / 3;
    EXPECT_EQ(triangles, 4u);
}

TEST_F(GltfOutNodes, CopiesByAttributesNeedNoPlaceOfTheNode) {
    Model model = shared_quad(1);
    const std::uint64_t places = model.floats("VEC3", 3, {0, 0, 0, 1, 0, 0, 2, 0, 0});
    model.root["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {{"TRANSLATION", places}};
    model.root["extensionsUsed"] = {"EXT_mesh_gpu_instancing"};
    const GltfDocument document = model.parse();
    const SceneRecord record = read_scene(document);
    GltfLightmaps maps = on_nodes(record, 2);
    maps.instances = copies_on_two_pages(record);
    const GltfDocument out = write_and_load(document, record, maps);
    ASSERT_EQ(out.json["nodes"].size(), 2u);
    for (std::size_t node = 0; node < 2; ++node) {
        EXPECT_FALSE(extension(out, node).contains("offset"));
        EXPECT_EQ(page_name(out, node), "lightmap" + std::to_string(node));
        EXPECT_TRUE(out.json["nodes"][node]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"].contains("_LIGHTMAP_OFFSET"));
    }

    const PrimitiveLayout second = maps.instances[1].mesh->front();
    for (std::size_t k = 0; k < 3; ++k) maps.instances[k] = laid_out({k ? second : scattered(record.meshes[0].primitives[0], [](std::size_t t) { return t ? 1u : 0u; })});
    const GltfDocument split = write_and_load(document, record, maps);
    ASSERT_EQ(split.json["nodes"].size(), 5u) << "three copies as nodes, and the other page of the first";
    EXPECT_EQ(split.json["nodes"][1]["children"], json{2});
    EXPECT_FALSE(split.json["nodes"][0].contains("extensions"));
}

TEST_F(GltfOutNodes, LightmapsOfBeforeGo) {
    Model model = shared_quad(2);
    model.root["images"] = json::array({{{"uri", "data:image/png;base64,iVBORw0KGgo="}}});
    model.root["textures"] = json::array({{{"source", 0}}});
    model.root["materials"][0]["extensions"]["MOZ_lightmap"] = {{"index", 0}, {"texCoord", 1}};
    model.root["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_1"] = model.floats("VEC2", 2, {9, 9, 8, 8, 7, 7, 6, 6});
    model.root["extensionsUsed"] = {"MOZ_lightmap"};
    const GltfDocument document = model.parse();
    const SceneRecord record = read_scene(document);
    GltfLightmaps maps = on_nodes(record);
    for (std::size_t k = 0; k < 2; ++k) maps.instances[k] = laid_out({welded(record.meshes[0].primitives[0], 0.25f * static_cast<float>(k))});
    const GltfDocument by_nodes = write_and_load(document, record, maps);
    const json& shown = by_nodes.json["meshes"][1]["primitives"][0];
    EXPECT_EQ(by_nodes.json["materials"][shown["material"].get<std::size_t>()], (json{{"name", "wood"}})) << "not lit twice";
    EXPECT_FALSE(shown["attributes"].contains("TEXCOORD_2"));

    // And back: the result of that as the input of a bake for materials.
    const SceneRecord again = read_scene(by_nodes);
    GltfLightmaps on_materials = lightmaps(again);
    for (std::size_t k = 0; k < 2; ++k) on_materials.instances[k] = laid_out({welded(again.meshes[k].primitives[0])});
    const GltfDocument out = write_and_load(by_nodes, again, on_materials);
    for (const json& node : out.json["nodes"]) EXPECT_FALSE(node.contains("extensions"));
    EXPECT_FALSE(out.json["meshes"][0]["primitives"][0]["attributes"].contains("TEXCOORD_2"));
    EXPECT_EQ(out.json["extensionsUsed"], json{"MOZ_lightmap"});
}

TEST_F(GltfOutNodes, AMovedSetClonesTheMaterialOnce) {
    Model model = shared_quad(1);
    model.root["images"] = json::array({{{"uri", "data:image/png;base64,iVBORw0KGgo="}}});
    model.root["textures"] = json::array({{{"source", 0}}});
    model.root["materials"][0]["occlusionTexture"] = {{"index", 0}, {"texCoord", 1}};
    json primitive = model.quad();
    primitive["attributes"]["TEXCOORD_0"] = primitive["attributes"]["TEXCOORD_1"] = model.floats("VEC2", 2, {0, 0, 1, 0, 1, 1, 0, 1});
    model.root["meshes"][0]["primitives"] = json::array({primitive, primitive});
    model.root["meshes"][0]["primitives"][1].erase("material");
    const GltfDocument document = model.parse();
    const SceneRecord record = read_scene(document);
    GltfLightmaps maps = on_nodes(record, 2);
    const auto& primitives = record.meshes[0].primitives;
    maps.instances[0] = laid_out({scattered(primitives[0], [](std::size_t t) { return t ? 1u : 0u; }), welded(primitives[1])});
    const GltfDocument out = write_and_load(document, record, maps);
    ASSERT_EQ(out.json["materials"].size(), 2u);
    EXPECT_EQ(out.json["materials"][1]["occlusionTexture"]["texCoord"], 2);
    for (std::size_t node = 0; node < 2; ++node)
        EXPECT_EQ(out.json["meshes"][out.json["nodes"][node]["mesh"].get<std::size_t>()]["primitives"][0]["material"], 1);
    EXPECT_FALSE(out.json["meshes"][0]["primitives"][1].contains("material")) << "the default material stays that";
}

TEST_F(GltfOutNodes, PartsOfASceneHaveTheirPages) {
    const GltfDocument document = shared_quad(2).parse();
    const SceneRecord record = read_scene(document);
    GltfLightmaps maps = on_nodes(record, 3);
    const PrimitiveRecord& primitive = record.meshes[0].primitives[0];
    maps.instances[0] = laid_out({scattered(primitive, [](std::size_t t) { return t ? 2u : 0u; })});
    maps.instances[1] = laid_out({scattered(primitive, [](std::size_t) { return 1u; })});
    GltfPacking packing;
    packing.split = GltfSplit{};
    packing.split->part_of_node = {0, 1};
    packing.split->part_count = 2;
    written = write_gltf(folder / "out.glb", document, record, maps, packing);
    ASSERT_EQ(written.parts.parts.size(), 2u);
    EXPECT_EQ(written.parts.parts[0].pages, (std::vector<std::uint32_t>{0, 2}));
    EXPECT_EQ(written.parts.parts[1].pages, (std::vector<std::uint32_t>{1}));
    const GltfDocument part = load_gltf(written.parts.parts[0].file);
    ASSERT_EQ(part.json["nodes"].size(), 2u);
    EXPECT_EQ(page_name(part, 0), "lightmap0");
    EXPECT_EQ(page_name(part, 1), "lightmap2");
    EXPECT_EQ(part.json["extensionsUsed"], json{"MX_lightmap"});
}

}  // namespace
}  // namespace luxel
