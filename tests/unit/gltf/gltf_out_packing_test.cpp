// Models with Draco and meshopt arrays, read back by the reader and compared with the plain model.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include "formats/base/file.h"
#include "formats/gltf/gltf_in.h"
#include "formats/gltf/gltf_out.h"
#include "formats/gltf/gltf_primitive.h"
#include "tests/unit/gltf/made_gltf_out.h"

namespace luxel {
namespace {

constexpr std::uint32_t page_size = 1024;
constexpr std::uint32_t side = 24;  ///< cells of the sheet

/// A bent sheet with every kind of attribute; `_ID` numbers its vertices, so that they are found again in any order.
json sheet(Model& model, bool with_targets = false) {
    std::vector<float> positions, normals, tangents, uv, weights, colours, moves;
    std::vector<std::uint16_t> ids, joints, indices;
    for (std::uint32_t y = 0; y <= side; ++y)
        for (std::uint32_t x = 0; x <= side; ++x) {
            const float u = static_cast<float>(x) / side, v = static_cast<float>(y) / side, bend = 3 * u;
            positions.insert(positions.end(), {2 * std::sin(bend), 5 * v - 1, 2 * std::cos(bend)});
            normals.insert(normals.end(), {std::sin(bend), 0, std::cos(bend)});
            tangents.insert(tangents.end(), {std::cos(bend), 0, -std::sin(bend), x % 2 ? 1.0f : -1.0f});
            uv.insert(uv.end(), {40 * u - 3, 100 * v});
            weights.insert(weights.end(), {1 - u, u, 0, 0});
            colours.insert(colours.end(), {u, v, 1, 1});
            moves.insert(moves.end(), {0, u * v, 0});
            ids.push_back(static_cast<std::uint16_t>(y * (side + 1) + x));
            joints.insert(joints.end(), {0, 1, static_cast<std::uint16_t>(x * 2000), 0});
        }
    for (std::uint16_t y = 0; y < side; ++y)
        for (std::uint16_t x = 0; x < side; ++x) {
            const auto a = static_cast<std::uint16_t>(y * (side + 1) + x), b = static_cast<std::uint16_t>(a + side + 1);
            for (const int index : {a + 0, b + 0, a + 1, a + 1, b + 0, b + 1}) indices.push_back(static_cast<std::uint16_t>(index));
        }
    json primitive = {{"attributes",
                       {{"POSITION", model.floats("VEC3", 3, positions)},
                        {"NORMAL", model.floats("VEC3", 3, normals)},
                        {"TANGENT", model.floats("VEC4", 4, tangents)},
                        {"TEXCOORD_0", model.floats("VEC2", 2, uv)},
                        {"WEIGHTS_0", model.floats("VEC4", 4, weights)},
                        {"COLOR_0", model.floats("VEC4", 4, colours)},
                        {"JOINTS_0", model.array("VEC4", 5123, 4, joints)},
                        {"_ID", model.array("SCALAR", 5123, 1, ids)}}},
                      {"indices", model.indices(indices)},
                      {"material", 0}};
    if (with_targets) primitive["targets"] = json::array({{{"POSITION", model.floats("VEC3", 3, moves)}}});
    return primitive;
}

/// Two charts side by side on the page: the sheet is cut in the middle.
PrimitiveLayout two_charts(const PrimitiveRecord& primitive) {
    PrimitiveLayout layout;
    layout.triangle_page.assign(primitive.indices.size() / 3, 0);
    for (std::size_t corner = 0; corner < primitive.indices.size(); ++corner) {
        const std::uint32_t vertex = primitive.indices[corner];
        const float shift = corner < primitive.indices.size() / 2 ? 0.013f : 0.517f;
        layout.corner_uv.emplace_back(static_cast<float>(vertex % (side + 1)) / 53.7f + shift,
                                      static_cast<float>(vertex) / 1700.0f);
    }
    return layout;
}

struct Triangle {
    std::array<std::uint16_t, 3> ids;
    std::array<std::uint32_t, 3> vertices;
};

/// The triangles by the numbers of their corners, each beginning with the smallest.
std::vector<Triangle> triangles_of(const PrimitiveArrays& arrays) {
    std::vector<Triangle> triangles;
    const Bytes& ids = arrays.attributes.at("_ID").data;
    for (std::size_t first = 0; first < arrays.indices.size(); first += 3) {
        Triangle triangle{};
        std::copy_n(arrays.indices.begin() + static_cast<std::ptrdiff_t>(first), 3, triangle.vertices.begin());
        for (std::size_t c = 0; c < 3; ++c) std::memcpy(&triangle.ids[c], ids.data() + 2 * triangle.vertices[c], 2);
        while (triangle.ids[0] != std::ranges::min(triangle.ids)) {
            std::ranges::rotate(triangle.ids, triangle.ids.begin() + 1);
            std::ranges::rotate(triangle.vertices, triangle.vertices.begin() + 1);
        }
        triangles.push_back(triangle);
    }
    std::ranges::sort(triangles, {}, &Triangle::ids);
    return triangles;
}

/// The largest difference of any component over the corners of all triangles.
double difference(const PrimitiveArrays& a, const PrimitiveArrays& b, const std::string& semantic) {
    const std::vector<Triangle> ta = triangles_of(a), tb = triangles_of(b);
    EXPECT_EQ(ta.size(), tb.size());
    const std::vector<float> va = to_floats(a.attributes.at(semantic)), vb = to_floats(b.attributes.at(semantic));
    const std::size_t components = a.attributes.at(semantic).components;
    EXPECT_EQ(components, b.attributes.at(semantic).components);
    double most = 0;
    for (std::size_t t = 0; t < std::min(ta.size(), tb.size()); ++t) {
        EXPECT_EQ(ta[t].ids, tb[t].ids);
        for (std::size_t c = 0; c < 3; ++c)
            for (std::size_t k = 0; k < components; ++k)
                most = std::max(most, std::abs(static_cast<double>(va[ta[t].vertices[c] * components + k]) -
                                               static_cast<double>(vb[tb[t].vertices[c] * components + k])));
    }
    return most;
}

class GltfOutPacking : public GltfOut {
  protected:
    static GltfPacking draco(const DracoBits& bits = {}) { return {.draco = bits, .meshopt = false, .page_size = page_size}; }
    static GltfPacking meshopt() { return {.draco = {}, .meshopt = true, .page_size = page_size}; }

    template <class Layout>
    GltfDocument bake_packed(const GltfDocument& document, const Layout& layout, const GltfPacking& packing,
                             const char* name = "packed.glb") {
        const SceneRecord record = read_scene(document);
        GltfLightmaps maps = lightmaps(record);
        maps.instances = laid_out_each(record, [&](std::size_t, const PrimitiveRecord& primitive) { return layout(primitive); });
        written = write_gltf(folder / name, document, record, maps, packing);
        return load_gltf(folder / name);
    }
    GltfDocument sheet_document(bool with_targets = false) {
        Model model;
        model.root["materials"] = json::array({json::object()});
        model.root["meshes"] = json::array({{{"primitives", json::array({sheet(model, with_targets)})}}});
        model.show(0, "sheet");
        return model.parse();
    }
    [[nodiscard]] std::uintmax_t bytes(const char* name) const { return std::filesystem::file_size(folder / name); }
};

TEST_F(GltfOutPacking, DracoKeepsSurfacesWithinTheSteps) {
    const GltfDocument document = sheet_document();
    const PrimitiveArrays plain = read_primitive(bake(document, two_charts), 0, 0);
    const GltfDocument out = bake_packed(document, two_charts, draco());
    const PrimitiveArrays packed = read_primitive(out, 0, 0);
    EXPECT_EQ(packed.attributes.size(), plain.attributes.size());
    // Half a step and rounding: the sheet is 5 m long, and no texture coordinate may move by more than 1/4096 repeat.
    EXPECT_LE(difference(plain, packed, "POSITION"), 5.0 / ((1 << 14) - 1) * 0.501);
    EXPECT_LE(difference(plain, packed, "TEXCOORD_1") * page_size, 1.0 / 32);
    EXPECT_LE(difference(plain, packed, "TEXCOORD_0"), 1.0 / 4096);
    EXPECT_LE(difference(plain, packed, "NORMAL"), 0.01);
    EXPECT_LE(difference(plain, packed, "WEIGHTS_0"), 0.501 / 4095);
    EXPECT_EQ(difference(plain, packed, "JOINTS_0"), 0);
    const std::vector<float> tangents = to_floats(packed.attributes.at("TANGENT"));
    for (std::size_t k = 3; k < tangents.size(); k += 4) EXPECT_NEAR(std::abs(tangents[k]), 1, 1e-6) << "its sign is all it says";
    EXPECT_GT(difference(plain, packed, "POSITION"), 0) << "nothing was quantised";
}

TEST_F(GltfOutPacking, DracoBitsDecide) {
    const GltfDocument document = sheet_document();
    const PrimitiveArrays plain = read_primitive(bake(document, two_charts), 0, 0);
    for (const int bits : {3, 8, 16, 20, 24}) {
        const PrimitiveArrays packed = read_primitive(
            bake_packed(document, two_charts, draco({bits, std::max(bits, 2), bits, bits, bits, bits})), 0, 0);
        // Half a step, and what a float of that size loses by three roundings: step, product, sum.
        const double steps = std::exp2(bits) - 1, rounding = 3 * std::exp2(-24);
        EXPECT_LE(difference(plain, packed, "POSITION"), 5 * (0.5 / steps + rounding)) << bits;
        EXPECT_LE(difference(plain, packed, "TEXCOORD_1"), 0.5 / steps + rounding) << bits;
        EXPECT_LE(difference(plain, packed, "TEXCOORD_0"), 1 / steps + 100 * rounding) << bits;
    }
}

TEST_F(GltfOutPacking, DracoAccessorsPromiseWhatTheStreamHolds) {
    const GltfDocument out = bake_packed(sheet_document(), two_charts, draco());
    EXPECT_EQ(out.json["extensionsRequired"], json{"KHR_draco_mesh_compression"});
    EXPECT_EQ(out.json["extensionsUsed"], (json{"MOZ_lightmap", "KHR_draco_mesh_compression"}));
    const json& primitive = out.json["meshes"][0]["primitives"][0];
    const PrimitiveArrays arrays = read_primitive(out, 0, 0);
    for (const auto& [semantic, accessor] : primitive["attributes"].items()) {
        const json& item = out.json["accessors"][accessor.get<std::size_t>()];
        EXPECT_EQ(item["count"], arrays.vertex_count) << semantic;
        EXPECT_FALSE(item.contains("bufferView")) << semantic;
    }
    EXPECT_EQ(out.json["accessors"][primitive["indices"].get<std::size_t>()]["count"], arrays.indices.size());
    EXPECT_EQ(out.json["accessors"].size(), primitive["attributes"].size() + 1) << "arrays that nobody uses have to go";
    EXPECT_EQ(out.json["bufferViews"].size(), 2u) << "the stream and the picture";
    const json& position = out.json["accessors"][primitive["attributes"]["POSITION"].get<std::size_t>()];
    const std::vector<float> values = to_floats(arrays.attributes.at("POSITION"));
    for (std::size_t c = 0; c < 3; ++c) {
        float low = values[c], high = values[c];
        for (std::size_t k = c; k < values.size(); k += 3) low = std::min(low, values[k]), high = std::max(high, values[k]);
        EXPECT_EQ(position["min"][c].get<float>(), low);
        EXPECT_EQ(position["max"][c].get<float>(), high);
    }
    EXPECT_TRUE(written.warnings.empty());
}

TEST_F(GltfOutPacking, DracoDropsOnlyTrianglesWithoutArea) {
    Model model;
    model.root["materials"] = json::array({json::object()});
    json primitive = sheet(model);
    std::vector<std::uint16_t> indices = {0, 0, 1};
    for (const std::uint32_t index : triangle_list(PrimitiveMode::triangles, read_primitive(sheet_document(), 0, 0).indices))
        indices.push_back(static_cast<std::uint16_t>(index));
    primitive["indices"] = model.indices(indices);
    model.root["meshes"] = json::array({{{"primitives", json::array({primitive})}}});
    model.show(0, "sheet");
    const PrimitiveArrays packed = read_primitive(bake_packed(model.parse(), weld, draco()), 0, 0);
    EXPECT_EQ(packed.indices.size(), indices.size() - 3);
}

/// A strip of the plane along z, `cells` long, from x0 to x1.
json band(Model& model, float x0, float x1, std::uint16_t cells, int material) {
    std::vector<float> positions;
    std::vector<std::uint16_t> indices;
    for (std::uint16_t k = 0; k <= cells; ++k) {
        const float z = static_cast<float>(k) * 0.37f;
        positions.insert(positions.end(), {x0, 0, z, x1, 0, z});
        if (k < cells)
            for (const int index : {2 * k, 2 * k + 2, 2 * k + 1, 2 * k + 1, 2 * k + 2, 2 * k + 3}) indices.push_back(static_cast<std::uint16_t>(index));
    }
    return {{"attributes", {{"POSITION", model.floats("VEC3", 3, positions)}}}, {"indices", model.indices(indices)}, {"material", material}};
}

TEST_F(GltfOutPacking, PrimitivesOfAMeshStillMeet) {
    Model model;
    model.root["materials"] = json::array({json::object(), json::object()});
    // The second begins and ends elsewhere, so that a grid of its own would lie elsewhere too.
    model.root["meshes"] = json::array({{{"primitives", json::array({band(model, -7, 0.123f, 40, 0), band(model, 0.123f, 1, 40, 1)})}}});
    model.show(0, "two");
    const GltfDocument out = bake_packed(model.parse(), weld, draco({.position = 9}));
    std::map<std::array<float, 3>, int> users;
    for (int p = 0; p < 2; ++p) {
        EXPECT_TRUE(out.json["meshes"][0]["primitives"][static_cast<std::size_t>(p)].contains("extensions"));
        const std::vector<float> values = to_floats(read_primitive(out, 0, p).attributes.at("POSITION"));
        for (std::size_t k = 0; k < values.size(); k += 3) ++users[{values[k], values[k + 1], values[k + 2]}];
    }
    EXPECT_EQ(std::ranges::count_if(users, [](const auto& user) { return user.second == 2; }), 41) << "the common edge is torn";
}

TEST_F(GltfOutPacking, WhatWouldGetLargerStaysPlain) {
    Model model;
    model.root["materials"] = json::array({json::object()});
    model.root["meshes"] = json::array({{{"primitives", json::array({model.quad()})}}});
    model.show(0, "quad");
    const GltfDocument document = model.parse();
    bake_packed(document, weld, draco(), "packed.glb");
    bake_packed(document, weld, {}, "plain.glb");
    EXPECT_EQ(read_file(folder / "packed.glb"), read_file(folder / "plain.glb"));
}

TEST_F(GltfOutPacking, EqualCopiesShareOneStream) {
    Model model;
    model.root["materials"] = json::array({json::object()});
    model.root["meshes"] = json::array({{{"primitives", json::array({sheet(model)})}}});
    model.show(0, "one");
    model.show(0, "other");
    const GltfDocument out = bake_packed(model.parse(), two_charts, draco());
    ASSERT_EQ(out.json["meshes"].size(), 2u);
    EXPECT_EQ(out.json["meshes"][0]["primitives"], out.json["meshes"][1]["primitives"]);
    EXPECT_EQ(out.json["bufferViews"].size(), 2u);
}

TEST_F(GltfOutPacking, MorphTargetsKeepTheirVertices) {
    const GltfDocument document = sheet_document(true);
    const GltfDocument plain = bake(document, two_charts), out = bake_packed(document, two_charts, draco());
    const PrimitiveArrays a = read_primitive(plain, 0, 0), b = read_primitive(out, 0, 0);
    EXPECT_EQ(a.indices, b.indices);
    EXPECT_EQ(a.attributes.at("_ID").data, b.attributes.at("_ID").data);
    const auto target = [](const GltfDocument& from) {
        return read_elements(from, from.json["meshes"][0]["primitives"][0]["targets"][0]["POSITION"].get<std::int64_t>(), "test").data;
    };
    EXPECT_EQ(target(plain), target(out));
    EXPECT_TRUE(out.json["meshes"][0]["primitives"][0]["extensions"].contains("KHR_draco_mesh_compression"));
}

TEST_F(GltfOutPacking, WhatDracoCannotTakeStays) {
    Model model;
    model.root["materials"] = json::array({json::object()});
    json lines = model.quad(), strip = model.quad(), odd = model.quad();
    lines["mode"] = 1;
    strip["mode"] = 5;
    odd["attributes"]["_HEAT"] = model.floats("SCALAR", 1, {0, std::numeric_limits<float>::quiet_NaN(), 1, 2});
    model.root["meshes"] = json::array({{{"primitives", json::array({lines, band(model, 0, 1, 40, 0)})}}, {{"primitives", json::array({strip, odd})}}});
    model.show(0, "baked");
    const GltfDocument document = model.parse();  // no node shows the second mesh: it stays as it is
    const GltfDocument out = bake_packed(document, weld, draco());
    EXPECT_EQ(out.json["meshes"][0]["primitives"][0]["mode"], 1);
    EXPECT_FALSE(out.json["meshes"][0]["primitives"][0].contains("extensions"));
    EXPECT_TRUE(out.json["meshes"][0]["primitives"][1].contains("extensions"));
    for (int p = 0; p < 2; ++p) {
        EXPECT_FALSE(out.json["meshes"][1]["primitives"][static_cast<std::size_t>(p)].contains("extensions"));
        EXPECT_EQ(read_primitive(out, 1, p).attributes.at("POSITION").data, read_primitive(document, 1, p).attributes.at("POSITION").data);
    }
    ASSERT_EQ(written.warnings.size(), 1u);
    EXPECT_EQ(written.warnings[0].code, "draco-left-out");
}

TEST_F(GltfOutPacking, MeshesWithoutLightmapAreCompressedToo) {
    const GltfDocument document = sheet_document();
    const SceneRecord record = read_scene(document);
    written = write_gltf(folder / "packed.glb", document, record, lightmaps(record), draco());
    const GltfDocument out = load_gltf(folder / "packed.glb");
    EXPECT_TRUE(out.json["meshes"][0]["primitives"][0]["extensions"].contains("KHR_draco_mesh_compression"));
    EXPECT_LE(difference(read_primitive(document, 0, 0), read_primitive(out, 0, 0), "POSITION"), 5.0 / ((1 << 14) - 1));
    // And again: what is Draco already is not encoded twice, which would quantise it twice.
    const SceneRecord again = read_scene(out);
    write_gltf(folder / "again.glb", out, again, lightmaps(again), draco());
    EXPECT_EQ(read_primitive(load_gltf(folder / "again.glb"), 0, 0).attributes.at("POSITION").data,
              read_primitive(out, 0, 0).attributes.at("POSITION").data);
}

TEST_F(GltfOutPacking, MeshoptChangesNoNumber) {
    Model model;
    model.root["materials"] = json::array({json::object()});
    model.root["meshes"] = json::array({{{"primitives", json::array({sheet(model, true)})}}});
    model.show(0, "sheet");
    std::vector<float> times, turns;
    for (std::uint32_t k = 0; k < 500; ++k) {
        times.push_back(static_cast<float>(k));
        turns.insert(turns.end(), {0, 0, 0, 1});
    }
    const std::size_t input = model.floats("SCALAR", 1, times), output = model.floats("VEC4", 4, turns);
    model.root["animations"] = json::array({{{"samplers", json::array({{{"input", input}, {"output", output}}})},
                                             {"channels", json::array({{{"sampler", 0}, {"target", {{"node", 0}, {"path", "rotation"}}}}})}}});
    const GltfDocument document = model.parse();
    const GltfDocument plain = bake_packed(document, two_charts, {}, "plain.glb");
    const GltfDocument out = bake_packed(document, two_charts, meshopt());
    ASSERT_EQ(out.json["accessors"], plain.json["accessors"]);
    EXPECT_EQ(out.json["extensionsRequired"], json{"EXT_meshopt_compression"});
    const std::size_t indices = out.json["meshes"][0]["primitives"][0]["indices"];
    for (std::size_t k = 0; k < out.json["accessors"].size(); ++k)
        if (k != indices) {
            EXPECT_EQ(read_elements(out, static_cast<std::int64_t>(k), "out").data, read_elements(plain, static_cast<std::int64_t>(k), "in").data) << k;
        }
    const PrimitiveArrays a = read_primitive(plain, 0, 0), b = read_primitive(out, 0, 0);
    for (const auto& [semantic, elements] : a.attributes) EXPECT_EQ(difference(a, b, semantic), 0) << semantic;

    ASSERT_EQ(out.json["buffers"].size(), 2u);
    EXPECT_EQ(out.json["buffers"][1]["extensions"]["EXT_meshopt_compression"]["fallback"], true);
    EXPECT_FALSE(out.json["buffers"][1].contains("uri"));
    std::map<std::string, int> modes;
    for (const json& view : out.json["bufferViews"]) {
        if (view["buffer"] == 0) continue;
        const json& packed = view["extensions"]["EXT_meshopt_compression"];
        ++modes[packed["mode"].get<std::string>()];
        EXPECT_EQ(view["byteLength"].get<std::uint64_t>(), packed["count"].get<std::uint64_t>() * packed["byteStride"].get<std::uint64_t>());
        EXPECT_LE(view["byteOffset"].get<std::uint64_t>() + view["byteLength"].get<std::uint64_t>(), out.json["buffers"][1]["byteLength"].get<std::uint64_t>());
        if (view.contains("byteStride")) {
            EXPECT_EQ(view["byteStride"], packed["byteStride"]);
        }
    }
    EXPECT_EQ(modes["TRIANGLES"], 1);
    EXPECT_GE(modes["ATTRIBUTES"], 8);
    EXPECT_LT(bytes("packed.glb"), bytes("plain.glb"));
}

TEST_F(GltfOutPacking, MeshoptLeavesWhatItsCodecCannotTake) {
    Model model;
    model.root["materials"] = json::array({json::object()});
    json primitive = sheet(model);
    std::vector<std::uint8_t> bytes_of_three, small_indices;
    for (std::uint32_t k = 0; k < 3 * 255; ++k) bytes_of_three.push_back(static_cast<std::uint8_t>(k % 7));
    for (std::uint32_t k = 0; k < 300; ++k) small_indices.push_back(static_cast<std::uint8_t>(k % 200));
    const std::size_t odd = model.array("VEC3", 5121, 3, bytes_of_three);  // three bytes apart
    const json lines = {{"attributes", {{"POSITION", primitive["attributes"]["POSITION"]}, {"_ODD", primitive["attributes"]["_ID"]}}},
                        {"indices", primitive["indices"]},
                        {"mode", 1}};
    const json points = {{"attributes", {{"POSITION", primitive["attributes"]["POSITION"]}}},
                         {"indices", model.array("SCALAR", 5121, 1, small_indices)},
                         {"mode", 0}};
    model.root["meshes"] = json::array({{{"primitives", json::array({primitive, lines, points})}}});
    model.root["meshes"][0]["extras"] = {{"unused", odd}};
    model.show(0, "sheet");
    const GltfDocument document = model.parse();
    const SceneRecord record = read_scene(document);
    write_gltf(folder / "packed.glb", document, record, lightmaps(record), meshopt());
    const GltfDocument out = load_gltf(folder / "packed.glb");
    const auto mode = [&](std::size_t accessor) -> std::string {
        const json& view = out.json["bufferViews"][out.json["accessors"][accessor]["bufferView"].get<std::size_t>()];
        return view.contains("extensions") ? view["extensions"]["EXT_meshopt_compression"]["mode"].get<std::string>() : "plain";
    };
    const json& written_primitives = out.json["meshes"][0]["primitives"];
    EXPECT_EQ(mode(odd), "plain");
    EXPECT_EQ(mode(written_primitives[0]["indices"]), "INDICES") << "lines use them too, so no corner may move";
    EXPECT_EQ(mode(written_primitives[2]["indices"]), "plain") << "8 bits";
    EXPECT_EQ(mode(written_primitives[0]["attributes"]["_ID"]), "plain") << "two bytes apart";
    EXPECT_EQ(mode(written_primitives[0]["attributes"]["POSITION"]), "ATTRIBUTES");
    for (std::size_t k = 0; k < out.json["accessors"].size(); ++k)
        EXPECT_EQ(read_elements(out, static_cast<std::int64_t>(k), "out").data, read_elements(document, static_cast<std::int64_t>(k), "in").data) << k;
}

TEST_F(GltfOutPacking, BothTogetherAndTheSameBytesTwice) {
    const GltfDocument document = sheet_document(true);
    GltfPacking both = draco();
    both.meshopt = true;
    const GltfDocument out = bake_packed(document, two_charts, both, "first.glb");
    bake_packed(document, two_charts, both, "second.glb");
    EXPECT_EQ(read_file(folder / "first.glb"), read_file(folder / "second.glb"));
    const json& primitive = out.json["meshes"][0]["primitives"][0];
    EXPECT_TRUE(primitive["extensions"].contains("KHR_draco_mesh_compression"));
    const json& target = out.json["accessors"][primitive["targets"][0]["POSITION"].get<std::size_t>()];
    EXPECT_TRUE(out.json["bufferViews"][target["bufferView"].get<std::size_t>()]["extensions"].contains("EXT_meshopt_compression"));
    EXPECT_EQ(read_primitive(out, 0, 0).indices, read_primitive(bake(document, two_charts), 0, 0).indices);
}

TEST_F(GltfOutPacking, TextModelsHaveThemToo) {
    const GltfDocument document = sheet_document();
    for (const GltfPacking& packing : {draco(), meshopt()}) {
        const GltfDocument out = bake_packed(document, two_charts, packing, "packed.gltf");
        EXPECT_LE(difference(read_primitive(bake(document, two_charts), 0, 0), read_primitive(out, 0, 0), "TEXCOORD_1") * page_size, 1.0 / 32);
    }
}

}  // namespace
}  // namespace luxel
