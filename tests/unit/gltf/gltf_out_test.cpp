// What the baked model says: what is added, and that everything else of the input survives.
#include "formats/gltf/gltf_out.h"

#include <gtest/gtest.h>

#include "formats/gltf/gltf_in.h"
#include "formats/gltf/gltf_primitive.h"
#include "tests/unit/gltf/made_gltf_out.h"

namespace luxel {
namespace {

TEST_F(GltfOut, KeepsEverythingElse) {
    Model model;
    model.root["materials"] = json::array({{{"name", "wall"}, {"extras", {{"tag", 7}}}, {"doubleSided", true}}});
    model.root["meshes"] = json::array({{{"name", "Mesh"},
                                         {"extras", "kept"},
                                         {"weights", json::array()},
                                         {"primitives", json::array({model.quad()})}}});
    model.root["meshes"][0].erase("weights");
    model.root["cameras"] = json::array({{{"type", "perspective"}, {"perspective", {{"yfov", 1.0}, {"znear", 0.1}}}}});
    model.show(0, "node");
    model.root["nodes"][0]["extras"] = {{"id", 3}};
    model.root["nodes"].push_back({{"camera", 0}, {"name", "eye"}});
    model.root["scenes"][0]["nodes"].push_back(1);
    const std::size_t times = model.floats("SCALAR", 1, {0, 1}), moves = model.floats("VEC3", 3, {0, 0, 0, 5, 6, 7});
    model.root["animations"] = json::array(
        {{{"samplers", json::array({{{"input", times}, {"output", moves}}})},
          {"channels", json::array({{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}})}}});
    model.root["unknownMember"] = {1, 2, 3};
    model.root["extensionsUsed"] = {"KHR_materials_unlit"};
    model.root["asset"]["copyright"] = "somebody";
    model.root["asset"]["extras"] = {{"other", 1}};
    const GltfDocument document = model.parse();
    const GltfDocument out = bake(document, scatter);

    for (const char* key : {"cameras", "nodes", "scenes", "scene", "unknownMember"})
        EXPECT_EQ(out.json[key], document.json[key]) << key;
    EXPECT_EQ(out.json["materials"][0], document.json["materials"][0]);
    EXPECT_EQ(out.json["meshes"][0]["name"], "Mesh");
    EXPECT_EQ(out.json["meshes"][0]["extras"], "kept");
    EXPECT_EQ(out.json["asset"]["generator"], "test tool");
    EXPECT_EQ(out.json["asset"]["copyright"], "somebody");
    EXPECT_EQ(out.json["asset"]["extras"]["other"], 1);
    EXPECT_EQ(out.json["asset"]["extras"]["luxel"]["version"], "9.9.9");
    EXPECT_EQ(out.json["extensionsUsed"], (json{"KHR_materials_unlit", "MOZ_lightmap"}));
    EXPECT_FALSE(out.json.contains("extensionsRequired"));
    const json& sampler = out.json["animations"][0]["samplers"][0];
    for (const auto& [key, old] : {std::pair{"input", times}, std::pair{"output", moves}})
        EXPECT_EQ(read_elements(out, sampler[key].get<std::int64_t>(), "out").data,
                  read_elements(document, static_cast<std::int64_t>(old), "in").data);

    const json& clone = out.json["materials"][1];
    EXPECT_EQ(clone["name"], "wall");
    EXPECT_EQ(clone["doubleSided"], true);
    EXPECT_EQ(clone["extras"]["tag"], 7);
    const json& lightmap = clone["extensions"]["MOZ_lightmap"];
    EXPECT_EQ(lightmap["texCoord"], 1);
    EXPECT_EQ(lightmap["intensity"], 2.5);
    EXPECT_EQ(lightmap["extras"], (json{{"quantity", "irradiance"}, {"unit", "lux"}, {"encoding", "srgb8"}, {"format", "png8"}, {"profile", "three"},
                                        {"irradianceFactor", 1.0}}));
    const json& image =
        out.json["images"][out.json["textures"][lightmap["index"].get<std::size_t>()]["source"].get<std::size_t>()];
    EXPECT_EQ(image["mimeType"], "image/png");
    const ByteView png = out.view(image["bufferView"].get<std::int64_t>(), "png");
    EXPECT_EQ(Bytes(png.begin(), png.end()), fake_png);
}

TEST_F(GltfOut, SplitsVerticesOnlyWhereTheLayoutIsCut) {
    Model model;
    model.root["materials"] = json::array({json::object()});
    model.root["meshes"] = json::array({{{"primitives", json::array({model.quad()})}}});
    model.show(0, "quad");
    const GltfDocument document = model.parse();
    const PrimitiveArrays before = read_primitive(document, 0, 0);
    const PrimitiveRecord source = read_scene(document).meshes[0].primitives[0];

    const PrimitiveArrays whole = read_primitive(bake(document, weld), 0, 0);
    EXPECT_EQ(whole.vertex_count, 4u);
    EXPECT_EQ(corners(whole, "POSITION"), corners(before, "POSITION"));
    EXPECT_EQ(corners(whole, "TEXCOORD_1"), bytes_of_uv(welded(source)));

    const GltfDocument out = bake(document, scatter);
    const PrimitiveArrays cut = read_primitive(out, 0, 0);
    EXPECT_EQ(cut.vertex_count, 6u);
    EXPECT_EQ(corners(cut, "POSITION"), corners(before, "POSITION"));
    EXPECT_EQ(corners(cut, "TEXCOORD_1"), bytes_of_uv(scattered(source)));
    const json& position =
        out.json["accessors"][out.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"].get<std::size_t>()];
    EXPECT_EQ(position["min"], (json{0.0, 0.0, 0.0}));
    EXPECT_EQ(position["max"], (json{1.0, 1.0, 0.0}));
    EXPECT_TRUE(cut.attributes.contains("TEXCOORD_0")) << "sets are numbered without gaps";
    for (const json& view : out.json["bufferViews"]) {
        EXPECT_EQ(view["byteOffset"].get<int>() % 4, 0);
        if (view.contains("byteStride")) {
            EXPECT_EQ(view["byteStride"].get<int>() % 4, 0);
        }
    }
}

TEST_F(GltfOut, OnePrimitivePerPageAndNoSurfaceIsLost) {
    Model model;
    model.root["materials"] = json::array({{{"name", "m"}}});
    model.root["meshes"] = json::array({{{"primitives", json::array({model.quad(), model.quad(), model.quad()})}}});
    model.show(0, "quads");
    const GltfDocument document = model.parse();
    const SceneRecord record = read_scene(document);
    GltfLightmaps maps = lightmaps(record, 2);
    const auto& primitives = record.meshes[0].primitives;
    maps.instances[0] = laid_out({scattered(primitives[0], [](std::size_t t) { return t == 0 ? 1u : 0u; }),
                         scattered(primitives[1], [](std::size_t t) { return t == 0 ? no_page : 1u; }),
                         scattered(primitives[2], [](std::size_t) { return no_page; })});
    const GltfDocument out = write_and_load(document, record, maps);
    const json& parts = out.json["meshes"][0]["primitives"];
    ASSERT_EQ(parts.size(), 4u);
    const auto page_name = [&](std::size_t part) -> std::string {
        const json& material = out.json["materials"][parts[part]["material"].get<std::size_t>()];
        if (!material.contains("extensions")) return "none";
        return out.json["textures"][material["extensions"]["MOZ_lightmap"]["index"].get<std::size_t>()]["name"];
    };
    EXPECT_EQ(page_name(0), "lightmap0");
    EXPECT_EQ(page_name(1), "lightmap1");
    EXPECT_EQ(page_name(2), "lightmap1");
    EXPECT_EQ(page_name(3), "none") << "a primitive without any place keeps its material";
    EXPECT_EQ(parts[1]["material"], parts[2]["material"]) << "one clone per (material, page)";
    EXPECT_EQ(out.json["materials"].size(), 3u);
    EXPECT_EQ(read_primitive(out, 0, 0).indices.size(), 3u);
    const PrimitiveArrays with_unplaced = read_primitive(out, 0, 2);
    EXPECT_EQ(with_unplaced.indices.size(), 6u);
    const Bytes uv = corners(with_unplaced, "TEXCOORD_1");
    EXPECT_EQ(Bytes(uv.begin(), uv.begin() + 24), Bytes(24, 0)) << "unplaced triangles lie at coordinate 0";
}

TEST_F(GltfOut, SharedMeshIsCopiedPerNodeAndEqualArraysAreStoredOnce) {
    Model model;
    model.root["materials"] = json::array({json::object()});
    model.root["meshes"] = json::array({{{"name", "chair"}, {"primitives", json::array({model.quad()})}}});
    model.show(0, "a");
    model.show(0, "b");
    model.root["nodes"].push_back({{"mesh", 0}, {"name", "outside the scene"}});
    const GltfDocument document = model.parse();
    const SceneRecord record = read_scene(document);
    GltfLightmaps maps = lightmaps(record);
    ASSERT_EQ(record.instances.size(), 2u);
    const PrimitiveRecord& primitive = record.meshes[0].primitives[0];
    maps.instances = {laid_out({welded(primitive)}), laid_out({welded(primitive, 0.5f)})};
    const GltfDocument out = write_and_load(document, record, maps);
    ASSERT_EQ(out.json["meshes"].size(), 3u);
    for (const json& mesh : out.json["meshes"]) EXPECT_EQ(mesh["name"], "chair");
    EXPECT_EQ(out.json["nodes"][2]["mesh"], 0);
    EXPECT_EQ(out.json["meshes"][0]["primitives"][0]["material"], 0) << "still shown as it was";
    const json& a = out.json["meshes"][out.json["nodes"][0]["mesh"].get<std::size_t>()]["primitives"][0];
    const json& b = out.json["meshes"][out.json["nodes"][1]["mesh"].get<std::size_t>()]["primitives"][0];
    EXPECT_EQ(a["attributes"]["POSITION"], b["attributes"]["POSITION"]);
    EXPECT_EQ(a["indices"], b["indices"]);
    EXPECT_EQ(a["material"], b["material"]);
    EXPECT_NE(a["attributes"]["TEXCOORD_1"], b["attributes"]["TEXCOORD_1"]);
}

TEST_F(GltfOut, CopiesOfOneLayoutShareAllArrays) {
    Model model;
    model.root["materials"] = json::array({json::object()});
    model.root["meshes"] = json::array({{{"name", "chair"}, {"primitives", json::array({model.quad()})}}});
    model.show(0, "a");
    model.show(0, "b");
    const GltfDocument document = model.parse();
    const SceneRecord record = read_scene(document);
    GltfLightmaps maps = lightmaps(record);
    maps.instances[0] = laid_out({welded(record.meshes[0].primitives[0])}, {{0.25f, 0.5f}, {0.125f, 0}});
    maps.instances[1] = {maps.instances[0].mesh, {{0.25f, 0.5f}, {0.5f, 0.25f}}};
    const GltfDocument out = write_and_load(document, record, maps);
    const json& a = out.json["meshes"][out.json["nodes"][0]["mesh"].get<std::size_t>()]["primitives"][0];
    const json& b = out.json["meshes"][out.json["nodes"][1]["mesh"].get<std::size_t>()]["primitives"][0];
    EXPECT_EQ(a["attributes"], b["attributes"]);
    EXPECT_EQ(a["indices"], b["indices"]);
    const auto place_of = [&](const json& primitive) {
        return out.json["materials"][primitive["material"].get<std::size_t>()]["extensions"]["MOZ_lightmap"]["extensions"]["KHR_texture_transform"];
    };
    EXPECT_EQ(place_of(a), (json{{"offset", {0.125, 0.0}}, {"scale", {0.25, 0.5}}}));
    EXPECT_EQ(place_of(b), (json{{"offset", {0.5, 0.25}}, {"scale", {0.25, 0.5}}}));
    EXPECT_EQ(out.json["extensionsUsed"], (json{"KHR_texture_transform", "MOZ_lightmap"}));
}

/// A node with copies at x = 0, 1, 2 and a custom attribute.
GltfDocument copied_quad(bool is_damaged = false) {
    Model model;
    model.root["materials"] = json::array({json::object()});
    model.root["meshes"] = json::array({{{"name", "tree"}, {"primitives", json::array({model.quad()})}}});
    model.show(0, "wood");
    const std::uint64_t places = model.floats("VEC3", 3, {0, 0, 0, 1, 0, 0, 2, 0, 0});
    const std::uint64_t kinds = model.floats("SCALAR", 1, {7, 8, 9});
    const std::uint64_t damaged = model.floats("SCALAR", 1, {1});  // too short for three
    model.root["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {{"TRANSLATION", places}, {"_KIND", kinds}};
    if (is_damaged) model.root["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["_SHORT"] = damaged;
    model.root["extensionsUsed"] = {"EXT_mesh_gpu_instancing"};
    return model.parse();
}

std::vector<float> instance_attribute(const GltfDocument& document, std::size_t node, const char* name) {
    const json& attributes = document.json["nodes"][node]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"];
    return to_floats(read_elements(document, attributes[name].get<std::int64_t>(), name));
}

TEST_F(GltfOut, CopiesOfANodeHaveTheirPlacesInAttributes) {
    const GltfDocument document = copied_quad();
    const SceneRecord record = read_scene(document);
    ASSERT_EQ(record.instances.size(), 3u);
    GltfLightmaps maps = lightmaps(record, 2);
    maps.instances = copies_on_two_pages(record);
    const GltfDocument out = write_and_load(document, record, maps);
    ASSERT_EQ(out.json["nodes"].size(), 2u);
    EXPECT_EQ(out.json["nodes"][0]["children"], json{1});
    EXPECT_EQ(instance_attribute(out, 0, "TRANSLATION"), (std::vector<float>{0, 0, 0, 2, 0, 0}));
    EXPECT_EQ(instance_attribute(out, 0, "_KIND"), (std::vector<float>{7, 9}));
    EXPECT_EQ(instance_attribute(out, 0, "_LIGHTMAP_OFFSET"), (std::vector<float>{0, 0, 0, 0.5f}));
    EXPECT_EQ(instance_attribute(out, 0, "_LIGHTMAP_SCALE"), (std::vector<float>{0.5f, 0.5f, 0.5f, 0.5f}));
    EXPECT_EQ(instance_attribute(out, 1, "TRANSLATION"), (std::vector<float>{1, 0, 0}));
    EXPECT_EQ(instance_attribute(out, 1, "_LIGHTMAP_OFFSET"), (std::vector<float>{0.25f, 0}));
    const auto page_of = [&](std::size_t node) {
        const json& mesh = out.json["meshes"][out.json["nodes"][node]["mesh"].get<std::size_t>()];
        const json& map = out.json["materials"][mesh["primitives"][0]["material"].get<std::size_t>()]["extensions"]["MOZ_lightmap"];
        EXPECT_FALSE(map.contains("extensions")) << "the places are attributes";
        return map["index"];
    };
    EXPECT_NE(page_of(0), page_of(1));
}

TEST_F(GltfOut, DamagedAttributesOfCopiesCostNoBake) {
    const GltfDocument document = copied_quad(true);
    const SceneRecord record = read_scene(document);
    GltfLightmaps maps = lightmaps(record, 2);
    maps.instances = copies_on_two_pages(record);
    maps.instances[2].mesh = maps.instances[1].mesh;
    const GltfDocument out = write_and_load(document, record, maps);
    EXPECT_EQ(instance_attribute(out, 1, "_KIND"), (std::vector<float>{8, 9}));
    EXPECT_FALSE(out.json["nodes"][1]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"].contains("_SHORT"));
    ASSERT_EQ(written.warnings.size(), 1u);
    EXPECT_EQ(written.warnings[0].code, "instance-attribute-lost");
}

TEST_F(GltfOut, CopiesWithoutPlacesBecomeNodes) {
    const GltfDocument document = copied_quad();
    const SceneRecord record = read_scene(document);
    GltfLightmaps maps = lightmaps(record);
    const PrimitiveRecord& primitive = record.meshes[0].primitives[0];
    for (std::size_t k = 0; k < 3; ++k) maps.instances[k] = laid_out({welded(primitive, 0.25f * static_cast<float>(k))});
    const GltfDocument out = write_and_load(document, record, maps);
    ASSERT_EQ(out.json["nodes"].size(), 4u);
    EXPECT_EQ(out.json["nodes"][0]["children"], (json{1, 2, 3}));
    EXPECT_FALSE(out.json["nodes"][0].contains("mesh"));
    EXPECT_EQ(out.json["nodes"][3]["translation"], (json{2.0, 0.0, 0.0}));
    EXPECT_EQ(out.json["extensionsUsed"], json{"MOZ_lightmap"});
    ASSERT_EQ(written.warnings.size(), 1u);
    EXPECT_EQ(written.warnings[0].code, "instance-attribute-lost");
    EXPECT_EQ(read_scene(out).instances.size(), 3u);
}

TEST_F(GltfOut, EveryAttributeKeepsItsTypeAndValues) {
    Model model;
    model.root["materials"] = json::array({json::object()});
    json primitive = model.quad();
    json& attributes = primitive["attributes"];
    attributes["NORMAL"] = model.array<std::int8_t>("VEC3", 5120, 3, {0, 0, 127, 1, 2, 3, 4, 5, 6, 7, 8, 9}, true, 4);
    attributes["TEXCOORD_0"] = model.array<std::uint16_t>("VEC2", 5123, 2, {0, 1, 2, 3, 4, 5, 6, 65535}, true);
    attributes["JOINTS_0"] =
        model.array<std::uint8_t>("VEC4", 5121, 4, {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15});
    attributes["WEIGHTS_0"] =
        model.array<std::uint8_t>("VEC4", 5121, 4, {255, 0, 0, 0, 9, 9, 9, 228, 1, 2, 3, 249, 0, 0, 0, 255}, true);
    attributes["COLOR_0"] = model.floats("VEC3", 3, {1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1});
    attributes["_CUSTOM"] = model.array<std::int16_t>("SCALAR", 5122, 1, {-5, 6, -7, 8});
    attributes["_MATRIX"] = model.array<std::uint8_t>(
        "MAT2", 5121, 8,
        {1, 2, 0, 0, 3, 4, 0, 0, 5, 6, 0, 0, 7, 8, 0, 0, 9, 10, 0, 0, 11, 12, 0, 0, 13, 14, 0, 0, 15, 16, 0, 0});
    const std::size_t lift = model.floats("VEC3", 3, {0, 0, 1, 0, 0, 2, 0, 0, 3, 0, 0, 4});
    primitive["targets"] = json::array({{{"POSITION", lift}}});
    model.root["meshes"] = json::array(
        {{{"primitives", json::array({primitive})}, {"weights", {0.5}}, {"extras", {{"targetNames", {"lift"}}}}}});
    model.root["accessors"][primitive["attributes"]["COLOR_0"].get<std::size_t>()]["name"] = "colours";
    model.show(0, "n");
    const GltfDocument document = model.parse();
    const PrimitiveArrays before = read_primitive(document, 0, 0);
    const GltfDocument out = bake(document, scatter);
    const PrimitiveArrays after = read_primitive(out, 0, 0);
    for (const auto& [semantic, elements] : before.attributes) {
        const AccessorBytes& now = after.attributes.at(semantic);
        EXPECT_EQ(now.component, elements.component) << semantic;
        EXPECT_EQ(now.type, elements.type) << semantic;
        EXPECT_EQ(now.normalized, elements.normalized) << semantic;
        EXPECT_EQ(corners(after, semantic), corners(before, semantic)) << semantic;
    }
    const json& mesh = out.json["meshes"][0];
    EXPECT_EQ(mesh["weights"], json{0.5});
    EXPECT_EQ(mesh["extras"]["targetNames"][0], "lift");
    const auto color = mesh["primitives"][0]["attributes"]["COLOR_0"].get<std::size_t>();
    EXPECT_EQ(out.json["accessors"][color]["name"], "colours");
    PrimitiveArrays morphed_before = before, morphed_after = after;
    morphed_before.attributes["POSITION"] = read_elements(document, static_cast<std::int64_t>(lift), "lift");
    morphed_after.attributes["POSITION"] =
        read_elements(out, mesh["primitives"][0]["targets"][0]["POSITION"].get<std::int64_t>(), "lift");
    EXPECT_EQ(corners(morphed_after, "POSITION"), corners(morphed_before, "POSITION"));
}

TEST_F(GltfOut, AnOldSecondSetMovesAndItsTexturesFollow) {
    Model model;
    model.root["images"] = json::array({{{"uri", "data:image/png;base64,iVBORw0KGgo="}}});
    model.root["textures"] = json::array({{{"source", 0}}});
    const json detail = {{"index", 0}, {"texCoord", 1}};
    model.root["materials"] =
        json::array({{{"occlusionTexture", detail}, {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}},
                     {{"extensions", {{"MOZ_lightmap", {{"index", 0}, {"texCoord", 1}, {"intensity", 9}}}}}}});
    json primitive = model.quad();
    const std::vector<float> old_uv{0, 0, 1, 0, 1, 1, 0, 1};
    primitive["attributes"]["TEXCOORD_0"] = model.floats("VEC2", 2, old_uv);
    primitive["attributes"]["TEXCOORD_1"] = model.floats("VEC2", 2, {9, 9, 8, 8, 7, 7, 6, 6});
    json baked_before = primitive;
    baked_before["material"] = 1;
    model.root["meshes"] = json::array({{{"primitives", json::array({primitive, baked_before})}}});
    model.show(0, "n");
    const GltfDocument document = model.parse();
    const GltfDocument out = bake(document, scatter);
    const PrimitiveArrays before = read_primitive(document, 0, 0), after = read_primitive(out, 0, 0);
    EXPECT_EQ(corners(after, "TEXCOORD_2"), corners(before, "TEXCOORD_1"));
    EXPECT_EQ(corners(after, "TEXCOORD_0"), corners(before, "TEXCOORD_0"));
    const auto material_of = [&](std::size_t p) {
        return out.json["materials"][out.json["meshes"][0]["primitives"][p]["material"].get<std::size_t>()];
    };
    EXPECT_EQ(material_of(0)["occlusionTexture"]["texCoord"], 2);
    EXPECT_FALSE(material_of(0)["pbrMetallicRoughness"]["baseColorTexture"].contains("texCoord"));
    EXPECT_EQ(material_of(0)["extensions"]["MOZ_lightmap"]["texCoord"], 1);
    EXPECT_EQ(out.json["materials"][0], document.json["materials"][0]);
    const PrimitiveArrays rebaked = read_primitive(out, 0, 1);
    EXPECT_FALSE(rebaked.attributes.contains("TEXCOORD_2")) << "an older lightmap's layout is replaced";
    EXPECT_EQ(material_of(1)["extensions"]["MOZ_lightmap"]["intensity"], 2.5);
}

TEST_F(GltfOut, StripsFansAndUnindexedBecomeTriangles) {
    Model model;
    const std::size_t positions = model.floats("VEC3", 3, {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0, 1, 2, 0});
    model.root["meshes"] = json::array({{{"primitives", json::array()}}});
    for (const int mode : {4, 5, 6, 1, 0})
        model.root["meshes"][0]["primitives"].push_back({{"attributes", {{"POSITION", positions}}}, {"mode", mode}});
    model.show(0, "n");
    const GltfDocument document = model.parse();
    const GltfDocument out = bake(document, scatter);
    for (std::int64_t p = 0; p < 3; ++p) {
        const PrimitiveArrays after = read_primitive(out, 0, p);
        EXPECT_EQ(after.mode, PrimitiveMode::triangles);
        EXPECT_EQ(corners(after, "POSITION"), corners(read_primitive(document, 0, p), "POSITION"));
    }
    for (std::int64_t p = 3; p < 5; ++p) {
        const PrimitiveArrays before = read_primitive(document, 0, p), after = read_primitive(out, 0, p);
        EXPECT_EQ(after.mode, before.mode);
        EXPECT_EQ(after.attributes.at("POSITION").data, before.attributes.at("POSITION").data);
        EXPECT_EQ(after.indices, before.indices);
    }
}

TEST_F(GltfOut, UnusedArraysGoUnlessAnUnknownExtensionMightNameThem) {
    Model model;
    model.root["meshes"] = json::array({{{"primitives", json::array({model.quad(-1)})}}});
    model.root["meshes"][0]["primitives"][0].erase("material");
    model.show(0, "n");
    const std::size_t unused_in_the_input = model.floats("SCALAR", 1, {4, 5, 6});
    const GltfDocument out = bake(model.parse(), weld);
    EXPECT_EQ(out.json["accessors"].size(), 4u) << "position, lightmap, indices, and what nothing used before";
    EXPECT_EQ(read_elements(out, 0, "kept").data,
              read_elements(model.parse(), static_cast<std::int64_t>(unused_in_the_input), "in").data);

    model.root["extensionsUsed"] = {"ACME_thing"};
    model.root["extensions"] = {{"ACME_thing", {{"accessor", 1}}}};
    const GltfDocument careful = bake(model.parse(), weld);
    EXPECT_EQ(careful.json["accessors"].size(), 6u);
    EXPECT_EQ(read_elements(careful, 1, "kept").data, read_elements(model.parse(), 1, "in").data);
    ASSERT_EQ(written.warnings.size(), 1u);
    EXPECT_EQ(written.warnings[0].code, "unused-arrays-kept");
}

TEST_F(GltfOut, VariantsGetClonesToo) {
    Model model;
    model.root["materials"] = json::array({{{"name", "day"}}, {{"name", "night"}}});
    json primitive = model.quad();
    primitive["extensions"] = {
        {"KHR_materials_variants", {{"mappings", json::array({{{"material", 1}, {"variants", {0}}}})}}}};
    model.root["meshes"] = json::array({{{"primitives", json::array({primitive})}}});
    model.show(0, "n");
    const GltfDocument out = bake(model.parse(), scatter);
    const json& baked = out.json["meshes"][0]["primitives"][0];
    const json& night =
        out.json["materials"]
                [baked["extensions"]["KHR_materials_variants"]["mappings"][0]["material"].get<std::size_t>()];
    EXPECT_EQ(night["name"], "night");
    EXPECT_TRUE(night["extensions"].contains("MOZ_lightmap"));
}

}  // namespace
}  // namespace luxel
