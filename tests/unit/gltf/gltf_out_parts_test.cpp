// A model in parts: every surface, lamp and camera in exactly one of them, and in each nothing that it does not use.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "formats/base/file.h"
#include "formats/gltf/gltf_in.h"
#include "formats/gltf/gltf_references.h"
#include "tests/unit/gltf/made_gltf_out.h"

namespace luxel {
namespace {

enum Node : std::size_t { hall, left, right, lamp, mover, child, bones, joint, wire };

/// A hall with two walls of one mesh, a lamp, a wall that an animation moves with a wall on it, a skin, and lines; the left
/// wall carries a camera. Walls are textured by one picture, and the right one by a second one too.
Model make_hall() {
    Model model;
    json& root = model.root;
    const auto picture = [&](std::uint8_t last) {
        Bytes bytes = fake_png;
        bytes.push_back(last);
        return "data:image/png;base64," + std::string(last == 1 ? "iVBORw0KGgoBAgMB" : "iVBORw0KGgoBAgMC");
    };
    root["images"] = {{{"uri", picture(1)}, {"name", "bricks"}}, {{"uri", picture(2)}, {"name", "moss"}}, {{"uri", picture(2)}, {"name", "unused"}}};
    root["samplers"] = {{{"wrapS", 33071}}, {{"wrapS", 33648}}};
    root["textures"] = {{{"source", 0}, {"sampler", 1}}, {{"source", 1}}, {{"source", 2}}};
    root["materials"] = {{{"name", "plain"}, {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}},
                         {{"name", "unused"}, {"emissiveTexture", {{"index", 2}}}},
                         {{"name", "mossy"}, {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}, {"occlusionTexture", {{"index", 1}}}}};
    json lines = model.quad(0), skinned = model.quad(0);
    lines["mode"] = 1;
    skinned["attributes"]["JOINTS_0"] = model.array("VEC4", 5121, 4, std::vector<std::uint8_t>(16, 0));
    skinned["attributes"]["WEIGHTS_0"] = model.floats("VEC4", 4, {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0});
    root["meshes"] = {{{"name", "wall"}, {"primitives", {model.quad(0)}}}, {{"name", "mossy wall"}, {"primitives", {model.quad(2)}}},
                      {{"name", "lines"}, {"primitives", {lines}}},        {{"name", "figure"}, {"primitives", {skinned}}}};
    root["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 1.0}, {"znear", 0.1}}}}};
    root["extensionsUsed"] = {"KHR_lights_punctual"};
    root["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}, {"name", "unused"}}, {{"type", "point"}, {"name", "bulb"}, {"intensity", 5.0}}};
    root["skins"] = {{{"joints", {joint}}, {"inverseBindMatrices", model.floats("MAT4", 16, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1})}}};
    root["nodes"] = {{{"name", "hall"}, {"translation", {10, 0, 0}}, {"children", {left, right, lamp, mover, bones, joint, wire}}, {"extras", {{"tag", 1}}}},
                     {{"name", "left"}, {"mesh", 0}, {"camera", 0}, {"scale", {1, 2, 1}}},
                     {{"name", "right"}, {"mesh", 1}, {"translation", {0, 0, 5}}},
                     {{"name", "lamp"}, {"translation", {0, 3, 0}}, {"extensions", {{"KHR_lights_punctual", {{"light", 1}}}}}},
                     {{"name", "mover"}, {"mesh", 0}, {"translation", {0, 0, 7}}, {"children", {child}}},
                     {{"name", "child"}, {"mesh", 0}, {"translation", {0, 1, 0}}},
                     {{"name", "bones"}, {"mesh", 3}, {"skin", 0}},
                     {{"name", "joint"}},
                     {{"name", "wire"}, {"mesh", 2}}};
    root["scenes"] = {{{"nodes", {hall}}, {"name", "the hall"}}};
    root["scene"] = 0;
    const std::size_t times = model.floats("SCALAR", 1, {0, 1}), moves = model.floats("VEC3", 3, {0, 0, 7, 5, 6, 7});
    root["animations"] = {{{"samplers", {{{"input", times}, {"output", moves}}}}, {"channels", {{{"sampler", 0}, {"target", {{"node", mover}, {"path", "translation"}}}}}}}};
    return model;
}

/// Corners of all triangles in world space, sorted: what a file shows.
using Surface = std::vector<std::array<Imath::V3f, 3>>;
Surface surface_of(const GltfDocument& document) {
    Surface surface;
    const SceneRecord record = read_scene(document);
    for (const InstanceRecord& instance : record.instances)
        for (const PrimitiveRecord& primitive : record.meshes[static_cast<std::size_t>(instance.mesh)].primitives)
            for (std::size_t k = 0; k < primitive.indices.size(); k += 3) {
                auto& triangle = surface.emplace_back();
                for (std::size_t c = 0; c < 3; ++c) triangle[c] = Imath::V3f(Imath::V3d(primitive.positions[primitive.indices[k + c]]) * instance.world);
            }
    return surface;
}
void sort(Surface& surface) {
    std::ranges::sort(surface, [](const auto& a, const auto& b) {
        return std::lexicographical_compare(a[0].getValue(), a[0].getValue() + 9, b[0].getValue(), b[0].getValue() + 9);
    });
}

/// Every object that nobody in the file names.
std::set<std::string> unused_objects(const GltfDocument& document) {
    json root = document.json;
    const std::map<GltfKind, const char*> arrays = {{GltfKind::accessor, "accessors"}, {GltfKind::buffer_view, "bufferViews"}, {GltfKind::mesh, "meshes"},
                                                    {GltfKind::material, "materials"}, {GltfKind::texture, "textures"}, {GltfKind::sampler, "samplers"},
                                                    {GltfKind::image, "images"}, {GltfKind::skin, "skins"}, {GltfKind::node, "nodes"}, {GltfKind::camera, "cameras"}};
    std::set<std::pair<GltfKind, std::uint64_t>> named;
    for (const auto& [kind, array] : arrays)
        for (std::size_t k = 0; k < (root.contains(array) ? root[array].size() : 0); ++k) {
            visit_references(kind, root[array][k], [&](GltfKind to, json& number, ArrayUse) { named.insert({to, number.get<std::uint64_t>()}); });
            if (kind == GltfKind::accessor && root[array][k].contains("bufferView")) named.insert({GltfKind::buffer_view, root[array][k]["bufferView"]});
        }
    for (const json& node : root["scenes"][0]["nodes"]) named.insert({GltfKind::node, node});
    for (const json& animation : root.value("animations", json::array()))
        for (const json& sampler : animation["samplers"]) {
            named.insert({GltfKind::accessor, sampler["input"]});
            named.insert({GltfKind::accessor, sampler["output"]});
        }
    std::set<std::string> unused;
    for (const auto& [kind, array] : arrays)
        for (std::size_t k = 0; k < (root.contains(array) ? root[array].size() : 0); ++k)
            if (!named.contains({kind, k})) unused.insert(std::string(array) + " " + std::to_string(k));
    return unused;
}

class GltfOutParts : public GltfOut {
  protected:
    GltfWritten write_hall(const GltfPacking& storage = {}, const char* name = "out.glb", Model model = make_hall()) {
        const GltfDocument document = model.parse();
        const SceneRecord record = read_scene(document);
        GltfLightmaps maps = lightmaps(record, 2);
        maps.instances = laid_out_each(record, [&](std::size_t k, const PrimitiveRecord& primitive) {
            return scattered(primitive, [&](std::size_t t) { return record.instances[k].node == right ? 0u : static_cast<std::uint32_t>(t); });
        });
        GltfPacking packing = storage;
        packing.split = GltfSplit{{-1, 0, 1, -1, 1, 0, 1, -1, -1}, 3, -1};
        return write_gltf(folder / name, document, record, maps, packing);
    }
    GltfDocument load(const GltfPart& part) const { return load_gltf(part.file); }
};

TEST_F(GltfOutParts, TogetherTheyShowTheSceneOnce) {
    for (const GltfPacking& storage : {GltfPacking{}, GltfPacking{.draco = DracoBits()}, GltfPacking{.draco = {}, .meshopt = true}}) {
        written = write_hall(storage);
        const GltfParts& parts = written.parts;
        ASSERT_EQ(parts.parts.size(), 3u);
        EXPECT_TRUE(parts.parts[2].file.empty()) << "nothing belongs to it";
        ASSERT_TRUE(parts.common);
        EXPECT_EQ(parts.parts[0].nodes, std::vector<std::uint64_t>{left});
        EXPECT_EQ(parts.parts[1].nodes, std::vector<std::uint64_t>{right});
        EXPECT_EQ(parts.parts[0].pages, (std::vector<std::uint32_t>{0, 1}));
        EXPECT_EQ(parts.parts[1].pages, std::vector<std::uint32_t>{0});
        Surface whole = surface_of(load_gltf(folder / "out.glb")), together;
        std::size_t lamps = 0, cameras = 0;
        for (const GltfPart* part : {&parts.parts[0], &parts.parts[1], &*parts.common}) {
            const GltfDocument document = load(*part);
            const Surface own = surface_of(document);
            together.insert(together.end(), own.begin(), own.end());
            lamps += read_scene(document).lamps.size();
            cameras += document.json.value("cameras", json::array()).size();
        }
        sort(whole), sort(together);
        EXPECT_EQ(whole.size(), 10u);
        EXPECT_EQ(whole, together);
        EXPECT_EQ(lamps, 1u);
        EXPECT_EQ(cameras, 1u);
        TearDown(), SetUp();
    }
}

TEST_F(GltfOutParts, NothingUnusedIsInThem) {
    written = write_hall();
    for (const GltfPart* part : {&written.parts.parts[0], &written.parts.parts[1], &*written.parts.common})
        EXPECT_EQ(unused_objects(load(*part)), std::set<std::string>()) << part->file;
    const json left_file = load(written.parts.parts[0]).json, common = load(*written.parts.common).json;
    EXPECT_FALSE(left_file.contains("extensions")) << "lamps are common";
    EXPECT_FALSE(left_file.contains("animations"));
    EXPECT_EQ(left_file["nodes"].size(), 2u) << "the wall and the hall";
    EXPECT_EQ(left_file["nodes"][0]["translation"], (json{10, 0, 0}));
    EXPECT_FALSE(left_file["nodes"][0].contains("extras")) << "they are the hall's, which is in the common file";
    EXPECT_EQ(left_file["scenes"][0]["name"], "the hall");
    EXPECT_EQ(common["extensions"]["KHR_lights_punctual"]["lights"].size(), 1u);
    EXPECT_EQ(common["nodes"][0]["extras"]["tag"], 1);
    for (const char* name : {"extensionsUsed"}) EXPECT_EQ(left_file[name], json{"MOZ_lightmap"});
}

TEST_F(GltfOutParts, WhatMovesStaysTogether) {
    written = write_hall();
    const GltfDocument document = load(*written.parts.common);
    const auto name_of = [&](const json& node) { return document.json["nodes"][node.get<std::size_t>()]["name"].get<std::string>(); };
    ASSERT_EQ(document.json["animations"].size(), 1u);
    const json& animation = document.json["animations"][0];
    EXPECT_EQ(name_of(animation["channels"][0]["target"]["node"]), "mover");
    EXPECT_EQ(to_floats(read_elements(document, animation["samplers"][0]["output"].get<std::int64_t>(), "test")), (std::vector<float>{0, 0, 7, 5, 6, 7}));
    EXPECT_EQ(name_of(document.json["skins"][0]["joints"][0]), "joint");
    std::set<std::string> names;
    for (const json& node : document.json["nodes"])
        if (node.contains("mesh")) names.insert(node["name"]);
    EXPECT_EQ(names, (std::set<std::string>{"mover", "child", "bones", "wire"}));
}

TEST_F(GltfOutParts, PicturesOfSeveralFilesAreWrittenOnce) {
    written = write_hall();
    std::map<std::string, std::map<std::string, std::string>> places;  // picture -> file -> uri, or "inside"
    for (const GltfPart* part : {&written.parts.parts[0], &written.parts.parts[1], &*written.parts.common}) {
        const GltfDocument document = load(*part);
        const json images = document.json.value("images", json::array());
        for (const json& image : images)
            places[image.value("name", "?")][part->file.filename().string()] = image.value("uri", "inside");
    }
    EXPECT_EQ(places["moss"], (std::map<std::string, std::string>{{"out.chunk1.glb", "inside"}}));
    ASSERT_EQ(places["bricks"].size(), 3u);
    const std::string uri = places["bricks"]["out.chunk0.glb"];
    for (const auto& [file, place] : places["bricks"]) EXPECT_EQ(place, uri);
    EXPECT_EQ(read_file(folder / uri).back(), 1);
    EXPECT_FALSE(places.contains("unused"));
    EXPECT_EQ(places["lightmap0"].size(), 3u);
    // A model with pictures beside it shares them with its parts.
    TearDown(), SetUp();
    written = write_hall({}, "out.gltf");
    EXPECT_TRUE(written.parts.pictures.empty());
    const GltfDocument document = load(written.parts.parts[0]);
    for (const json& image : document.json["images"]) {
        // What was a data URI of the input: there are none in a GLB.
        const bool was_data = image["name"] == "bricks" || image["name"] == "moss";
        const std::string place = image.value("uri", "inside");
        EXPECT_EQ(place == "inside", was_data) << place;
        if (was_data) {
            EXPECT_EQ(document.view(image["bufferView"].get<std::int64_t>(), "picture").back(), image["name"] == "bricks" ? 1 : 2);
        } else {
            EXPECT_TRUE(std::filesystem::exists(folder / place)) << place;
        }
    }
}

TEST_F(GltfOutParts, NumbersInPointersFollowAndUnknownOnesGo) {
    Model model = make_hall();
    const std::size_t times = model.floats("SCALAR", 1, {0, 1}), values = model.floats("SCALAR", 1, {2, 3});
    const auto channel = [](const char* pointer) -> json {
        return {{"sampler", 0}, {"target", {{"path", "pointer"}, {"extensions", {{"KHR_animation_pointer", {{"pointer", pointer}}}}}}}};
    };
    model.root["animations"].push_back({{"samplers", {{{"input", times}, {"output", values}}}},
                                        {"channels", {channel("/extensions/KHR_lights_punctual/lights/1/intensity"), channel("/materials/2/alphaCutoff"),
                                                      channel("/nodes/7/scale"), channel("/elsewhere/1")}}});
    model.root["nodes"][left]["extensions"]["ODD_reference"] = {{"thing", 3}};
    model.root["nodes"][left]["extensions"]["ODD_colour"] = {{"name", "red"}};
    model.root["extensionsUsed"].push_back("ODD_reference");
    model.root["extensionsUsed"].push_back("ODD_colour");
    written = write_hall({}, "out.glb", model);
    const json common = load(*written.parts.common).json, part = load(written.parts.parts[0]).json;
    std::vector<std::string> pointers;
    for (const json& kept : common["animations"][1]["channels"]) pointers.push_back(kept["target"]["extensions"]["KHR_animation_pointer"]["pointer"]);
    ASSERT_EQ(pointers.size(), 2u) << "the material is in no common mesh, and the last names nothing";
    EXPECT_EQ(pointers[0], "/extensions/KHR_lights_punctual/lights/0/intensity");
    std::size_t joint_number = 0;
    while (common["nodes"][joint_number]["name"] != "joint") ++joint_number;
    EXPECT_EQ(pointers[1], "/nodes/" + std::to_string(joint_number) + "/scale");
    EXPECT_EQ(part["nodes"][1]["extensions"], (json{{"ODD_colour", {{"name", "red"}}}}));
    EXPECT_EQ(part["extensionsUsed"], (json{"ODD_colour", "MOZ_lightmap"}));
    std::set<std::string> codes;
    for (const Warning& warning : written.warnings) codes.insert(warning.code);
    EXPECT_TRUE(codes.contains("extension-left-out"));
    EXPECT_TRUE(codes.contains("channels-left-out"));
}

TEST_F(GltfOutParts, PicturesStayInTheFolder) {
    Model model = make_hall();
    model.root["images"][0] = {{"bufferView", model.root["accessors"][model.array("SCALAR", 5121, 1, std::vector<std::uint8_t>(8, 7))]["bufferView"]},
                               {"mimeType", "image/../../evil"}};
    written = write_hall({}, "out.glb", model);
    ASSERT_FALSE(written.parts.pictures.empty());
    for (const auto& picture : written.parts.pictures) EXPECT_EQ(picture.lexically_normal().parent_path(), folder.lexically_normal()) << picture;
    EXPECT_TRUE(std::filesystem::exists(folder / "out.image0"));
}

TEST_F(GltfOutParts, SameBytesTwiceAndAllOrNothing) {
    written = write_hall();
    std::map<std::filesystem::path, Bytes> first;
    for (const auto& file : written.files) first[file.filename()] = read_file(file);
    EXPECT_EQ(first.size(), file_count());
    TearDown(), SetUp();
    written = write_hall();
    for (const auto& file : written.files) EXPECT_EQ(first[file.filename()], read_file(file)) << file;
    TearDown(), SetUp();
    std::filesystem::create_directories(folder / "out.common.glb");
    EXPECT_THROW(write_hall(), Error);
    EXPECT_EQ(file_count(), 0u);
}

}  // namespace
}  // namespace luxel
