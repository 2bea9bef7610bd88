#include "formats/gltf/gltf_compression.h"

#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <meshoptimizer.h>

#include <cmath>

#include "formats/base/file.h"
#include "formats/gltf/gltf_in.h"
#include "formats/gltf/gltf_primitive.h"
#include "tests/unit/gltf/made_gltf.h"

namespace luxel {
namespace {

using nlohmann::json;
using test::bad_input_of;
using test::MadeGltf;
using testing::HasSubstr;

/// A fan around a centre: enough vertices for several blocks of the codec.
struct Grid {
    std::vector<float> positions;
    std::vector<std::uint32_t> indices;
    explicit Grid(std::uint32_t side) {
        for (std::uint32_t y = 0; y <= side; ++y)
            for (std::uint32_t x = 0; x <= side; ++x)
                positions.insert(positions.end(), {static_cast<float>(x), static_cast<float>(y), static_cast<float>(x % 3)});
        for (std::uint32_t y = 0; y < side; ++y)
            for (std::uint32_t x = 0; x < side; ++x) {
                const std::uint32_t a = y * (side + 1) + x, b = a + side + 1;
                indices.insert(indices.end(), {a, a + 1, b, b, a + 1, b + 1});
            }
    }
    [[nodiscard]] std::size_t vertex_count() const { return positions.size() / 3; }
};

Bytes encode_vertices(const void* data, std::size_t count, std::size_t stride) {
    Bytes out(meshopt_encodeVertexBufferBound(count, stride), std::uint8_t{0});
    const std::size_t size = meshopt_encodeVertexBuffer(out.data(), out.size(), data, count, stride);
    return Bytes(out.begin(), out.begin() + static_cast<std::ptrdiff_t>(size));
}

/// A view whose data exists only compressed; returns its index.
std::size_t compressed_view(MadeGltf& made, const Bytes& encoded, std::size_t count, std::size_t stride, const char* mode,
                            const char* filter, const char* extension = "EXT_meshopt_compression") {
    const std::size_t view = made.view(encoded);
    json& item = made.json["bufferViews"][view];
    item["extensions"][extension] = {{"buffer", 0}, {"byteOffset", item["byteOffset"]}, {"byteLength", encoded.size()},
                                     {"count", count}, {"byteStride", stride}, {"mode", mode}, {"filter", filter}};
    item["byteLength"] = count * stride;
    return view;
}

MadeGltf meshopt_grid(const Grid& grid, const char* index_mode, std::size_t index_bytes, const char* extension) {
    MadeGltf made;
    const Bytes vertices = encode_vertices(grid.positions.data(), grid.vertex_count(), 12);
    const auto p = made.accessor(compressed_view(made, vertices, grid.vertex_count(), 12, "ATTRIBUTES", "NONE", extension),
                                 5126, "VEC3", grid.vertex_count());
    const bool triangles = std::string(index_mode) == "TRIANGLES";
    Bytes encoded(triangles ? meshopt_encodeIndexBufferBound(grid.indices.size(), grid.vertex_count())
                            : meshopt_encodeIndexSequenceBound(grid.indices.size(), grid.vertex_count()), std::uint8_t{0});
    const std::size_t size =
        triangles ? meshopt_encodeIndexBuffer(encoded.data(), encoded.size(), grid.indices.data(), grid.indices.size())
                  : meshopt_encodeIndexSequence(encoded.data(), encoded.size(), grid.indices.data(), grid.indices.size());
    encoded.erase(encoded.begin() + static_cast<std::ptrdiff_t>(size), encoded.end());
    const auto i = made.accessor(compressed_view(made, encoded, grid.indices.size(), index_bytes, index_mode, "NONE", extension),
                                 index_bytes == 2 ? 5123 : 5125, "SCALAR", grid.indices.size());
    made.primitive(p)["indices"] = i;
    return made;
}

TEST(GltfMeshopt, VerticesTrianglesAndSequences) {
    const Grid grid(40);
    for (const char* extension : {"EXT_meshopt_compression", "KHR_meshopt_compression"})
        for (const char* mode : {"TRIANGLES", "INDICES"})
            for (const std::size_t index_bytes : {2, 4}) {
                const SceneRecord record = read_scene(meshopt_grid(grid, mode, index_bytes, extension).document());
                const PrimitiveRecord& primitive = record.meshes[0].primitives[0];
                EXPECT_EQ(primitive.positions[100], Imath::V3f(grid.positions[300], grid.positions[301], grid.positions[302]));
                ASSERT_EQ(primitive.indices.size(), grid.indices.size());
                for (std::size_t t = 0; t < grid.indices.size(); t += 3) {
                    // The codec may turn a triangle's corners round, never mirror it.
                    std::array<std::uint32_t, 3> got{primitive.indices[t], primitive.indices[t + 1], primitive.indices[t + 2]};
                    while (got[0] != grid.indices[t]) std::ranges::rotate(got, got.begin() + 1);
                    EXPECT_EQ(got[1], grid.indices[t + 1]);
                    EXPECT_EQ(got[2], grid.indices[t + 2]);
                }
            }
}

TEST(GltfMeshopt, Filters) {
    MadeGltf made;
    constexpr std::size_t count = 300;
    std::vector<float> normals, quaternions, numbers;
    for (std::size_t i = 0; i < count; ++i) {
        const float a = static_cast<float>(i) * 0.1f;
        normals.insert(normals.end(), {std::cos(a), std::sin(a) * 0.8f, std::sin(a) * 0.6f, 0.0f});
        quaternions.insert(quaternions.end(), {std::sin(a), 0.0f, 0.0f, std::cos(a)});
        numbers.insert(numbers.end(), {a, -a * 1000.0f});
    }
    const auto add = [&](std::size_t stride, const auto& encode, const char* filter, int component, const char* type) {
        Bytes filtered(count * stride, std::uint8_t{0});
        encode(filtered.data());
        const auto a = made.accessor(compressed_view(made, encode_vertices(filtered.data(), count, stride), count, stride,
                                                     "ATTRIBUTES", filter), component, type, count);
        made.json["accessors"][a]["normalized"] = component != 5126;
        return a;
    };
    const auto n8 = add(4, [&](void* to) { meshopt_encodeFilterOct(to, count, 4, 8, normals.data()); }, "OCTAHEDRAL", 5120, "VEC3");
    const auto n16 = add(8, [&](void* to) { meshopt_encodeFilterOct(to, count, 8, 16, normals.data()); }, "OCTAHEDRAL", 5122, "VEC3");
    const auto q = add(8, [&](void* to) { meshopt_encodeFilterQuat(to, count, 8, 16, quaternions.data()); }, "QUATERNION", 5122, "VEC4");
    const auto e = add(8, [&](void* to) { meshopt_encodeFilterExp(to, count, 8, 15, numbers.data()); }, "EXPONENTIAL", 5126, "VEC2");
    const GltfDocument document = made.document();
    const auto floats = [&](std::size_t a) { return to_floats(read_elements(document, static_cast<std::int64_t>(a), "t")); };
    const auto got8 = floats(n8), got16 = floats(n16), got_q = floats(q), got_e = floats(e);
    for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t c = 0; c < 3; ++c) {
            EXPECT_NEAR(got8[3 * i + c], normals[4 * i + c], 0.03);
            EXPECT_NEAR(got16[3 * i + c], normals[4 * i + c], 2e-4);
        }
        const float turn = got_q[4 * i] * quaternions[4 * i] + got_q[4 * i + 3] * quaternions[4 * i + 3];
        EXPECT_NEAR(std::abs(turn), 1, 1e-3);
        EXPECT_NEAR(got_e[2 * i + 1], numbers[2 * i + 1], std::abs(numbers[2 * i + 1]) * 1e-3 + 2.0);
    }
}

TEST(GltfMeshopt, HeaderFaultsAreNamedBeforeDecoding) {
    const MadeGltf good = meshopt_grid(Grid(8), "TRIANGLES", 4, "EXT_meshopt_compression");
    const auto with = [&](std::size_t view, const char* key, const json& value) {
        MadeGltf made = good;
        made.json["bufferViews"][view]["extensions"]["EXT_meshopt_compression"][key] = value;
        return bad_input_of([&] { read_scene(made.document()); });
    };
    EXPECT_THAT(with(0, "mode", "ODD"), HasSubstr("\"ODD\""));
    EXPECT_THAT(with(0, "byteStride", 10), HasSubstr("multiple of 4"));
    EXPECT_THAT(with(1, "byteStride", 8), HasSubstr("2 or 4"));
    EXPECT_THAT(with(1, "count", 4), HasSubstr("multiple of 3"));
    EXPECT_THAT(with(0, "count", 1000000000), HasSubstr("cannot come from"));
    EXPECT_THAT(with(0, "count", 9007199254740992), HasSubstr("cannot come from"));
    EXPECT_THAT(with(0, "filter", "ODD"), HasSubstr("\"ODD\""));
    EXPECT_THAT(with(0, "filter", "OCTAHEDRAL"), HasSubstr("4 or 8"));
    EXPECT_THAT(with(1, "filter", "EXPONENTIAL"), HasSubstr("on indices"));
    EXPECT_THAT(with(0, "byteLength", 10), testing::AllOf(HasSubstr("mesh \"m\" primitive 0"), HasSubstr("decoder refuses")));
    EXPECT_THAT(with(0, "byteOffset", 9007199254740992), HasSubstr("needs bytes"));
    EXPECT_THAT(with(0, "buffer", 3), HasSubstr("\"buffer\" is 3"));
}

TEST(GltfMeshopt, FallbackBufferMayBeEmpty) {
    MadeGltf made = meshopt_grid(Grid(8), "TRIANGLES", 4, "EXT_meshopt_compression");
    json text = made.json;
    const json fallback = json::parse(R"({"byteLength":100000,"extensions":{"EXT_meshopt_compression":{"fallback":true}}})");
    text["buffers"] = {{{"byteLength", made.body.size()}, {"uri", "body.bin"}}, fallback};
    for (json& view : text["bufferViews"]) view["buffer"] = 1;
    const auto folder = std::filesystem::temp_directory_path() / "luxel_gltf_compression_test";
    std::filesystem::create_directories(folder);
    publish_file(folder / "body.bin", made.body);
    const std::string dumped = text.dump();
    const SceneRecord record =
        read_scene(parse_gltf({reinterpret_cast<const std::uint8_t*>(dumped.data()), dumped.size()}, "f.gltf", folder));
    EXPECT_EQ(record.meshes[0].primitives[0].indices.size(), 6u * 64);
    std::filesystem::remove_all(folder);
}

/// The same grid as a Draco stream, positions as floats and one 8-bit UV-like attribute, which it calls `color_type`; ids by semantic.
Bytes draco_grid(const Grid& grid, std::uint32_t& position_id, std::uint32_t& color_id, draco::DataType color_type) {
    draco::TriangleSoupMeshBuilder builder;
    builder.Start(static_cast<int>(grid.indices.size() / 3));
    const int position = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
    const int color = builder.AddAttribute(draco::GeometryAttribute::COLOR, 4, color_type);
    for (std::size_t t = 0; t < grid.indices.size() / 3; ++t) {
        const float* p[3];
        std::array<std::array<std::uint8_t, 4>, 3> c{};
        for (std::size_t k = 0; k < 3; ++k) {
            p[k] = &grid.positions[3 * std::size_t{grid.indices[3 * t + k]}];
            c[k] = {static_cast<std::uint8_t>(p[k][0]), static_cast<std::uint8_t>(p[k][1]), 0, 255};
        }
        const draco::FaceIndex face(static_cast<std::uint32_t>(t));
        builder.SetAttributeValuesForFace(position, face, p[0], p[1], p[2]);
        builder.SetAttributeValuesForFace(color, face, c[0].data(), c[1].data(), c[2].data());
    }
    const auto mesh = builder.Finalize();
    position_id = mesh->attribute(position)->unique_id();
    color_id = mesh->attribute(color)->unique_id();
    draco::Encoder encoder;
    draco::EncoderBuffer buffer;
    EXPECT_TRUE(encoder.EncodeMeshToBuffer(*mesh, &buffer).ok());
    return Bytes(buffer.data(), buffer.data() + buffer.size());
}

/// Two primitives share one stream; the second has float colours, another component type than the stream's.
MadeGltf draco_gltf(const Grid& grid, draco::DataType color_type = draco::DT_UINT8) {
    MadeGltf made;
    std::uint32_t position_id = 0, color_id = 0;
    const auto view = made.view(draco_grid(grid, position_id, color_id, color_type));
    const std::size_t n = grid.vertex_count();
    const auto describe = [&](int component, const char* type, std::size_t count) {
        made.json["accessors"].push_back({{"componentType", component}, {"type", type}, {"count", count}});
        return made.json["accessors"].size() - 1;
    };
    const auto p = describe(5126, "VEC3", n), c8 = describe(5121, "VEC4", n), c32 = describe(5126, "VEC4", n);
    const auto i = describe(5123, "SCALAR", grid.indices.size());
    json primitive = {{"attributes", {{"POSITION", p}, {"COLOR_0", c8}}}, {"indices", i}};
    primitive["extensions"]["KHR_draco_mesh_compression"] = {
        {"bufferView", view}, {"attributes", {{"POSITION", position_id}, {"COLOR_0", color_id}}}};
    json second = primitive;
    second["attributes"]["COLOR_0"] = c32;
    made.primitive(p);
    made.json["meshes"][0]["primitives"] = {primitive, second};
    return made;
}

TEST(GltfDraco, TwoPrimitivesShareAStream) {
    const Grid grid(9);
    const GltfDocument document = draco_gltf(grid).document();
    const PrimitiveArrays bytes = read_primitive(document, 0, 0), floats = read_primitive(document, 0, 1);
    EXPECT_EQ(bytes.indices.size(), grid.indices.size());
    EXPECT_EQ(bytes.indices, floats.indices);
    EXPECT_EQ(bytes.attributes.at("COLOR_0").element_bytes(), 4u);
    EXPECT_EQ(floats.attributes.at("COLOR_0").element_bytes(), 16u);
    const auto positions = to_floats(bytes.attributes.at("POSITION")), color8 = to_floats(bytes.attributes.at("COLOR_0")),
               color32 = to_floats(floats.attributes.at("COLOR_0"));
    EXPECT_EQ(color8, color32);
    for (std::size_t v = 0; v < grid.vertex_count(); ++v) EXPECT_NEAR(color8[4 * v], positions[3 * v], 0.01);
    EXPECT_EQ(read_scene(document).meshes[0].primitives.size(), 2u);
}

TEST(GltfDraco, FaultsAreNamed) {
    const MadeGltf good = draco_gltf(Grid(5));
    const auto error_with = [&](const auto& change) {
        MadeGltf made = good;
        change(made.json["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"], made.json);
        return bad_input_of([&] { read_primitive(made.document(), 0, 0); });
    };
    EXPECT_THAT(error_with([](json& draco, json&) { draco["attributes"]["POSITION"] = 77; }), HasSubstr("id 77"));
    EXPECT_THAT(error_with([](json& draco, json&) { draco["bufferView"] = 77; }), HasSubstr("bufferViews[77]"));
    EXPECT_THAT(error_with([](json&, json& root) { root["accessors"][0]["count"] = 7; }), HasSubstr("has 7 elements"));
    EXPECT_THAT(error_with([](json&, json& root) { root["accessors"][0]["type"] = "VEC2"; }), HasSubstr("VEC2"));
    EXPECT_THAT(error_with([](json&, json& root) { root["bufferViews"][0]["byteLength"] = 20; }),
                testing::AllOf(HasSubstr("mesh \"m\" primitive 0"), HasSubstr("Draco")));
}

TEST(GltfDraco, TruthValuesAreNoNumbers) {
    const MadeGltf made = draco_gltf(Grid(5), draco::DT_BOOL);  // with bytes such as 2 and 255
    EXPECT_THAT(bad_input_of([&] { read_primitive(made.document(), 0, 0); }), HasSubstr("Draco attribute COLOR_0: the compressed data has truth values"));
}

TEST(GltfDraco, DamagedStreamsNeverCrash) {
    const MadeGltf good = draco_gltf(Grid(5));
    for (std::size_t at = 0; at < good.body.size(); ++at) {
        MadeGltf made = good;
        made.body[at] = static_cast<std::uint8_t>(made.body[at] ^ (1u << (at % 8)));
        bad_input_of([&] { read_scene(made.document()); });
        MadeGltf cut = good;
        cut.json["bufferViews"][0]["byteLength"] = at;
        EXPECT_NE(bad_input_of([&] { read_scene(cut.document()); }), "");
    }
}

}  // namespace
}  // namespace luxel
