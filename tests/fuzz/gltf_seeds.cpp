#include "tests/fuzz/gltf_seeds.h"

#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <meshoptimizer.h>

#include "tests/unit/gltf/made_gltf.h"

namespace luxel::fuzz {
namespace {

using nlohmann::json;
using test::MadeGltf;

const std::vector<float> corners{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
const std::vector<std::uint32_t> triangles{0, 1, 2, 0, 2, 3};

/// A square with indices, normals, two sets of coordinates, a textured material, a lamp of each kind and a camera to
/// skip.
MadeGltf furnished() {
    MadeGltf made;
    const auto p = made.square();
    const auto n =
        made.array(std::vector<std::int8_t>{0, 0, 127, 0, 0, 0, 127, 0, 0, 0, 127, 0, 0, 0, 127, 0}, 5120, "VEC3", 4);
    made.json["bufferViews"].back()["byteStride"] = 4;
    made.json["accessors"][n]["normalized"] = true;
    const auto uv = made.array(std::vector<float>{0, 0, 1, 0, 1, 1, 0, 1}, 5126, "VEC2", 4);
    const auto i = made.array(std::vector<std::uint16_t>{0, 1, 2, 0, 2, 3}, 5123, "SCALAR", 6);
    const auto image = made.view(Bytes{11, 200, 100, 50});
    json& primitive = made.primitive(p);
    primitive["indices"] = i;
    primitive["material"] = 0;
    primitive["attributes"].update({{"NORMAL", n}, {"TEXCOORD_0", uv}, {"TEXCOORD_1", uv}});
    made.json["images"] = {{{"bufferView", image}, {"mimeType", "image/png"}}, {{"uri", "data:image/png;base64,AAEC"}}};
    made.json["samplers"] = {{{"wrapS", 33071}, {"magFilter", 9728}}};
    made.json["textures"] = {{{"source", 0}, {"sampler", 0}},
                             {{"extensions", {{"EXT_texture_webp", {{"source", 1}}}}}}};
    made.json["materials"] =
        json::parse(R"([{"doubleSided": true, "alphaMode": "MASK", "alphaCutoff": 0.3, "emissiveFactor": [1, 1, 0],
        "emissiveTexture": {"index": 1},
        "pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.5, 0.5, 1], "metallicFactor": 0.1,
            "baseColorTexture": {"index": 0, "texCoord": 1, "extensions": {"KHR_texture_transform": {"offset": [0.1, 0], "rotation": 1, "scale": [2, 2], "texCoord": 0}}}},
        "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 5}}}])");
    made.json["extensions"] =
        json::parse(R"({"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": 5, "range": 3},
        {"type": "spot", "color": [1, 0, 0], "spot": {"innerConeAngle": 0.1, "outerConeAngle": 0.5}}, {"type": "directional"}]}})");
    made.json["nodes"].push_back(
        json::parse(R"({"scale": [1, -2, 1], "rotation": [0, 0, 0.7071, 0.7071], "mesh": 0, "children": [2, 3, 4]})"));
    for (int lamp = 0; lamp < 3; ++lamp)
        made.json["nodes"].push_back(
            {{"translation", {0, lamp, 1}}, {"extensions", {{"KHR_lights_punctual", {{"light", lamp}}}}}});
    made.json["scenes"][0]["nodes"].push_back(1);
    return made;
}

/// Sparse positions, a strip of triangles, and the mesh drawn at three places by one node.
MadeGltf sparse_instances() {
    MadeGltf made;
    const auto p = made.square();
    const auto where = made.view(std::vector<std::uint8_t>{1, 3}),
               what = made.view(std::vector<float>{2, 0, 0, 0, 2, 0});
    made.json["accessors"][p]["sparse"] = {{"count", 2},
                                           {"indices", {{"bufferView", where}, {"componentType", 5121}}},
                                           {"values", {{"bufferView", what}}}};
    const auto t = made.array(std::vector<float>{0, 0, 0, 5, 0, 0, 0, 5, 0}, 5126, "VEC3", 3);
    const auto r =
        made.array(std::vector<std::int16_t>{0, 0, 0, 32767, 0, 0, 32767, 0, 0, 32767, 0, 0}, 5122, "VEC4", 3);
    made.json["accessors"][r]["normalized"] = true;
    made.primitive(p)["mode"] = 5;
    made.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {{"TRANSLATION", t},
                                                                                    {"ROTATION", r}};
    return made;
}

MadeGltf meshopt() {
    MadeGltf made;
    const auto compressed = [&](const Bytes& encoded, std::size_t count, std::size_t stride, const char* mode) {
        const auto view = made.view(encoded);
        json& item = made.json["bufferViews"][view];
        item["extensions"]["EXT_meshopt_compression"] = {{"buffer", 0},
                                                         {"byteOffset", item["byteOffset"]},
                                                         {"byteLength", item["byteLength"]},
                                                         {"count", count},
                                                         {"byteStride", stride},
                                                         {"mode", mode}};
        item["byteLength"] = count * stride;
        return view;
    };
    Bytes vertices(meshopt_encodeVertexBufferBound(4, 12));
    vertices.resize(meshopt_encodeVertexBuffer(vertices.data(), vertices.size(), corners.data(), 4, 12));
    Bytes indices(meshopt_encodeIndexBufferBound(6, 4));
    indices.resize(meshopt_encodeIndexBuffer(indices.data(), indices.size(), triangles.data(), 6));
    const auto p = made.accessor(compressed(vertices, 4, 12, "ATTRIBUTES"), 5126, "VEC3", 4);
    const auto i = made.accessor(compressed(indices, 6, 4, "TRIANGLES"), 5125, "SCALAR", 6);
    made.primitive(p)["indices"] = i;
    return made;
}

MadeGltf draco_stream() {
    draco::TriangleSoupMeshBuilder builder;
    builder.Start(2);
    const int position = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
    for (std::uint32_t t = 0; t < 2; ++t) {
        const auto corner = [&](std::size_t k) { return &corners[3 * std::size_t{triangles[3 * t + k]}]; };
        builder.SetAttributeValuesForFace(position, draco::FaceIndex(t), corner(0), corner(1), corner(2));
    }
    const auto mesh = builder.Finalize();
    draco::Encoder encoder;
    draco::EncoderBuffer buffer;
    if (!encoder.EncodeMeshToBuffer(*mesh, &buffer).ok()) throw std::runtime_error("Draco does not encode a square");
    MadeGltf made;
    const auto view = made.view(std::vector<char>(buffer.data(), buffer.data() + buffer.size()));
    made.json["accessors"] = json::parse(
        R"([{"componentType": 5126, "type": "VEC3"}, {"componentType": 5123, "type": "SCALAR", "count": 6}])");
    made.json["accessors"][0]["count"] = mesh->num_points();
    json& primitive = made.primitive(0);
    primitive["indices"] = 1;
    primitive["extensions"]["KHR_draco_mesh_compression"] = {
        {"bufferView", view}, {"attributes", {{"POSITION", mesh->attribute(position)->unique_id()}}}};
    return made;
}

}  // namespace

std::vector<std::pair<std::string, Bytes>> gltf_seeds() {
    return {{"furnished", furnished().glb()},
            {"sparse_instances", sparse_instances().glb()},
            {"meshopt", meshopt().glb()},
            {"draco", draco_stream().glb()}};
}

}  // namespace luxel::fuzz
