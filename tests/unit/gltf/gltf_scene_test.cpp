/// Nodes, primitives and materials as read_scene gives them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "formats/gltf/gltf_in.h"
#include "formats/gltf/gltf_primitive.h"
#include "tests/unit/gltf/made_gltf.h"

namespace luxel {
namespace {

using nlohmann::json;
using test::bad_input_of;
using test::MadeGltf;
using testing::ElementsAre;
using testing::HasSubstr;

bool has_warning(const SceneRecord& record, const std::string& code) {
    return std::ranges::any_of(record.warnings, [&](const Warning& w) { return w.code == code; });
}

TEST(GltfPrimitive, TriangleListsOfAllModes) {
    const std::vector<std::uint32_t> five{10, 11, 12, 13, 14};
    EXPECT_THAT(triangle_list(PrimitiveMode::triangles, five), ElementsAre(10, 11, 12));
    EXPECT_THAT(triangle_list(PrimitiveMode::triangle_strip, five), ElementsAre(10, 11, 12, 11, 13, 12, 12, 13, 14));
    EXPECT_THAT(triangle_list(PrimitiveMode::triangle_fan, five), ElementsAre(11, 12, 10, 12, 13, 10, 13, 14, 10));
    for (const auto mode : {PrimitiveMode::triangles, PrimitiveMode::triangle_strip, PrimitiveMode::triangle_fan})
        EXPECT_TRUE(triangle_list(mode, {1, 2}).empty());
    EXPECT_TRUE(triangle_list(PrimitiveMode::lines, five).empty());
}

TEST(GltfPrimitive, IndexedAndNotIndexed) {
    MadeGltf made;
    made.primitive(made.square())["mode"] = 5;
    EXPECT_THAT(read_scene(made.document()).meshes[0].primitives[0].indices, ElementsAre(0, 1, 2, 1, 3, 2));
    const auto indices = made.array(std::vector<std::uint8_t>{3, 2, 1, 0}, 5121, "SCALAR", 4);
    made.json["meshes"][0]["primitives"][0]["indices"] = indices;
    EXPECT_THAT(read_scene(made.document()).meshes[0].primitives[0].indices, ElementsAre(3, 2, 1, 2, 0, 1));
}

TEST(GltfPrimitive, BadIndicesNameMeshAndPrimitive) {
    MadeGltf made;
    const auto square = made.square();
    const auto indices = made.array(std::vector<std::uint16_t>{0, 1, 4}, 5123, "SCALAR", 3);
    made.primitive(square)["indices"] = indices;
    EXPECT_THAT(bad_input_of([&] { read_scene(made.document()); }),
                testing::AllOf(HasSubstr("mesh \"m\" primitive 0"), HasSubstr("index 4"), HasSubstr("4 vertices")));
}

TEST(GltfPrimitive, AttributesMustAgree) {
    MadeGltf made;
    const auto square = made.square();
    const auto three = made.array(std::vector<float>(6), 5126, "VEC2", 3);
    made.primitive(square)["attributes"]["TEXCOORD_0"] = three;
    EXPECT_THAT(bad_input_of([&] { read_scene(made.document()); }), HasSubstr("TEXCOORD_0 has 3 elements"));
    made.json["meshes"][0]["primitives"][0]["attributes"] = {{"POSITION", three}};
    EXPECT_THAT(bad_input_of([&] { read_scene(made.document()); }), HasSubstr("POSITION: expected VEC3, found VEC2"));
    made.json["meshes"][0]["primitives"][0]["attributes"] = {{"POSITION", "x"}};
    EXPECT_THAT(bad_input_of([&] { read_scene(made.document()); }), HasSubstr("whole number"));
    made.json["meshes"][0]["primitives"][0]["mode"] = 7;
    EXPECT_THAT(bad_input_of([&] { read_scene(made.document()); }), HasSubstr("mode"));
}

TEST(GltfPrimitive, PointsAndLinesAreSkippedWithAWarning) {
    for (const int mode : {0, 1, 2, 3}) {
        MadeGltf made;
        made.primitive(made.square())["mode"] = mode;
        const SceneRecord record = read_scene(made.document());
        EXPECT_TRUE(record.meshes[0].primitives.empty());
        EXPECT_TRUE(has_warning(record, "no-triangles"));
    }
}

TEST(GltfPrimitive, QuantizedPositionsAndUv) {
    MadeGltf made;
    const auto positions = made.view(std::vector<std::uint16_t>{0, 0, 0, 0, 65535, 0, 0, 0, 0, 65535, 0, 0}, 8);
    const auto p = made.accessor(positions, 5123, "VEC3", 3);
    const auto uv = made.array(std::vector<std::uint8_t>{0, 0, 255, 0, 0, 255}, 5121, "VEC2", 3);
    const auto normals = made.view(std::vector<std::int8_t>{0, 0, 127, 0, 0, 0, 127, 0, 0, 0, 127, 0}, 4);
    const auto n = made.accessor(normals, 5120, "VEC3", 3);
    made.json["accessors"][uv]["normalized"] = true;
    made.json["accessors"][n]["normalized"] = true;
    made.primitive(p)["attributes"].update({{"TEXCOORD_0", uv}, {"NORMAL", n}});
    const SceneRecord record = read_scene(made.document());
    const PrimitiveRecord& primitive = record.meshes[0].primitives[0];
    EXPECT_EQ(primitive.positions[1], Imath::V3f(65535, 0, 0));
    EXPECT_EQ(primitive.uv[0][2], Imath::V2f(0, 1));
    EXPECT_EQ(primitive.normals[0], Imath::V3f(0, 0, 1));
    EXPECT_TRUE(primitive.uv[1].empty());
}

TEST(GltfNodes, PathsAreUniqueAndMatricesAreDoubles) {
    MadeGltf made;
    made.primitive(made.square());
    made.json["nodes"] = json::parse(R"([
        {"name": "hall", "translation": [1000000.0000001, 0, 0], "children": [1, 2, 3, 4, 5]},
        {"name": "a", "mesh": 0, "scale": [2, 2, 2]}, {"name": "a", "mesh": 0}, {"name": "a:1", "mesh": 0},
        {"mesh": 0, "rotation": [0, 0, 0.7071067811865476, 0.7071067811865476]},
        {"name": "b/c@1", "mesh": 0, "matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 5,6,7,1]}])");
    made.json["scenes"][0]["nodes"] = {0};
    const SceneRecord record = read_scene(made.document());
    ASSERT_EQ(record.instances.size(), 5u);
    std::vector<std::string> paths;
    for (const InstanceRecord& instance : record.instances) paths.push_back(instance.node_path);
    EXPECT_THAT(paths, ElementsAre("/hall/a", "/hall/a:1", "/hall/a:1:1", "/hall/#4", "/hall/b%2Fc%401"));
    EXPECT_EQ(record.instances[0].world[3][0], 1000000.0000001);
    EXPECT_EQ(record.instances[0].world[0][0], 2);
    Imath::V3d x;
    record.instances[3].world.multDirMatrix(Imath::V3d(1, 0, 0), x);
    EXPECT_NEAR((x - Imath::V3d(0, 1, 0)).length(), 0, 1e-12);
    EXPECT_EQ(record.instances[4].world[3][1], 6);
    EXPECT_EQ(record.instances[4].gpu_instance, -1);
}

TEST(GltfNodes, CyclesSharedChildrenAndDepthAreErrors) {
    MadeGltf made;
    made.primitive(made.square());
    const auto with_nodes = [&](const json& nodes) {
        MadeGltf other = made;
        other.json["nodes"] = nodes;
        other.json["scenes"][0]["nodes"] = {0};
        return bad_input_of([&] { read_scene(other.document()); });
    };
    EXPECT_THAT(with_nodes(json::parse(R"([{"children":[1]},{"children":[0]}])")), HasSubstr("cycle"));
    EXPECT_THAT(with_nodes(json::parse(R"([{"children":[0]}])")), HasSubstr("cycle"));
    EXPECT_THAT(with_nodes(json::parse(R"([{"children":[1,2]},{"children":[2]},{}])")), HasSubstr("more than one parent"));
    EXPECT_THAT(with_nodes(json::parse(R"([{"children":[9]}])")), HasSubstr("node 9 is wanted"));
    EXPECT_THAT(with_nodes(json::parse(R"([{"mesh":9}])")), HasSubstr("\"mesh\" is 9"));
    EXPECT_THAT(with_nodes(json::parse(R"([{"matrix":[1,2]}])")), HasSubstr("16 numbers"));
    json chain = json::array();
    for (int i = 0; i < 5000; ++i) chain.push_back({{"children", {i + 1}}});
    chain.push_back(json::object());
    EXPECT_THAT(with_nodes(chain), HasSubstr("deeper than"));
}

TEST(GltfNodes, TheDefaultSceneIsReadOthersAreNamed) {
    MadeGltf made;
    made.primitive(made.square());
    made.json["nodes"] = json::parse(R"([{"name":"x","mesh":0},{"name":"y","mesh":0}])");
    made.json["scenes"] = json::parse(R"([{"nodes":[0]},{"nodes":[1]}])");
    made.json["scene"] = 1;
    const SceneRecord record = read_scene(made.document());
    EXPECT_EQ(record.instances[0].node_path, "/y");
    EXPECT_TRUE(has_warning(record, "other-scenes"));
    EXPECT_EQ(read_scene(made.document(), {.scene = 0}).instances[0].node_path, "/x");
    EXPECT_NE(bad_input_of([&] { read_scene(made.document(), {.scene = 2}); }), "");
    made.json.erase("scenes");
    made.json.erase("scene");
    EXPECT_EQ(read_scene(made.document()).instances.size(), 2u);
}

TEST(GltfNodes, ScenesAreFoundByNumberAndName) {
    MadeGltf made;
    made.primitive(made.square());
    made.json["nodes"] = json::parse(R"([{"name":"x","mesh":0}])");
    made.json["scenes"] = json::parse(R"([{"name":"day","nodes":[0]},{"name":"night","nodes":[0]},{"name":"day"},{"name":"0"}])");
    const GltfDocument document = made.document();
    EXPECT_EQ(find_scene(document, "3"), 3);
    EXPECT_EQ(find_scene(document, "night"), 1);
    EXPECT_EQ(find_scene(document, "0"), 0) << "a number comes first";
    for (const char* wanted : {"day", "dawn", "4", "-1", "1x", ""})
        EXPECT_THAT(bad_input_of([&] { find_scene(document, wanted); }), HasSubstr("0 \"day\", 1 \"night\", 2 \"day\", 3 \"0\"")) << wanted;
    made.json.erase("scenes");
    made.json.erase("scene");
    const GltfDocument none = made.document();
    EXPECT_THAT(bad_input_of([&] { find_scene(none, "0"); }), HasSubstr("among: none"));
}

TEST(GltfNodes, SkinnedMeshesStandAtRestOrAreLeftOut) {
    MadeGltf made;
    made.primitive(made.square());
    made.json["nodes"] = json::parse(R"([{"name":"hero","mesh":0,"skin":0},{"name":"wall","mesh":0}])");
    made.json["scenes"][0]["nodes"] = {0, 1};
    made.json["skins"] = json::parse(R"([{"joints":[1]}])");
    const SceneRecord all = read_scene(made.document());
    EXPECT_EQ(all.instances.size(), 2u);
    EXPECT_TRUE(has_warning(all, "skinned-rest-pose"));
    const SceneRecord still = read_scene(made.document(), {.skip_skinned = true});
    ASSERT_EQ(still.instances.size(), 1u);
    EXPECT_EQ(still.instances[0].node_path, "/wall");
    EXPECT_TRUE(has_warning(still, "skinned-skipped"));
    EXPECT_FALSE(has_warning(still, "skinned-rest-pose"));
}

TEST(GltfNodes, GpuInstancesAreExpanded) {
    MadeGltf made;
    made.primitive(made.square());
    const auto t = made.array(std::vector<float>{1, 2, 3, 4, 5, 6}, 5126, "VEC3", 2);
    const auto r = made.array(std::vector<std::int16_t>{0, 0, 0, 32767, 0, 0, 32767, 0}, 5122, "VEC4", 2);
    made.json["accessors"][r]["normalized"] = true;
    made.json["nodes"][0]["translation"] = {100, 0, 0};
    made.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {{"TRANSLATION", t}, {"ROTATION", r}};
    const SceneRecord record = read_scene(made.document());
    ASSERT_EQ(record.instances.size(), 2u);
    EXPECT_EQ(record.instances[1].node_path, "/n@1");
    EXPECT_EQ(record.instances[1].gpu_instance, 1);
    EXPECT_EQ(record.instances[1].world[3][0], 104);
    EXPECT_NEAR(record.instances[1].world[0][0], -1, 1e-12);
    const auto one = made.array(std::vector<float>{1, 1, 1}, 5126, "VEC3", 1);
    made.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["SCALE"] = one;
    EXPECT_THAT(bad_input_of([&] { read_scene(made.document()); }), HasSubstr("another attribute has"));
}

TEST(GltfNodes, Lamps) {
    MadeGltf made;
    made.primitive(made.square());
    made.json["extensions"]["KHR_lights_punctual"]["lights"] = json::parse(R"([
        {"type":"spot","color":[1,0.5,0],"intensity":10,"range":7,"spot":{"innerConeAngle":0.1,"outerConeAngle":0.2}},
        {"type":"directional"}, {"type":"area"}])");
    made.json["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 0;
    const SceneRecord record = read_scene(made.document());
    ASSERT_EQ(record.lamps.size(), 1u);
    EXPECT_EQ(record.lamps[0].kind, LampKind::spot);
    EXPECT_THAT(record.lamps[0].intensity, ElementsAre(10, 5, 0));
    EXPECT_EQ(record.lamps[0].range, 7);
    EXPECT_EQ(record.lamps[0].outer_cone, 0.2);
    made.json["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 1;
    EXPECT_EQ(read_scene(made.document()).lamps[0].kind, LampKind::directional);
    made.json["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 2;
    EXPECT_THAT(bad_input_of([&] { read_scene(made.document()); }), HasSubstr("\"area\""));
    made.json["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 3;
    EXPECT_NE(bad_input_of([&] { read_scene(made.document()); }), "");
}

TEST(GltfNodes, SizesOfLamps) {
    MadeGltf made;
    made.primitive(made.square());
    auto& lights = made.json["extensions"]["KHR_lights_punctual"]["lights"];
    lights = json::parse(R"([{"type":"point","range":0}, {"type":"directional","extras":{"angle":0.5,"radius":9}}])");
    made.json["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 0;
    SceneRecord record = read_scene(made.document());
    EXPECT_LT(record.lamps[0].radius, 0) << "none is given";
    EXPECT_EQ(std::ranges::count(record.warnings, "lamp-range", &Warning::code), 1);
    lights[0]["extras"]["radius"] = 0.25;
    EXPECT_EQ(read_scene(made.document()).lamps[0].radius, 0.25);
    made.json["nodes"][0]["extras"] = json::parse(R"({"radius":0,"angle":3})");
    record = read_scene(made.document());
    EXPECT_EQ(record.lamps[0].radius, 0) << "the node knows better than the light that it shares";
    EXPECT_LT(record.lamps[0].angle_degrees, 0) << "a point has no angle";
    for (const char* other : {R"("text")", R"([1])", R"({"radius":"wide"})", "7"}) {
        made.json["nodes"][0]["extras"] = json::parse(other);
        EXPECT_EQ(read_scene(made.document()).lamps[0].radius, 0.25) << other << " is somebody else's";
    }
    made.json["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 1;
    EXPECT_EQ(read_scene(made.document()).lamps[0].angle_degrees, 0.5);
}

TEST(GltfSky, TheLargestMipOfTheScenesLight) {
    MadeGltf made;
    made.primitive(made.square());
    EXPECT_FALSE(read_scene(made.document()).sky.is_there);
    for (int k = 0; k < 12; ++k)
        made.json["images"].push_back({{"uri", "data:image/png;base64,QU" + std::string(1, static_cast<char>('A' + k)) + "B"}});
    made.json["extensionsUsed"] = {"EXT_lights_image_based"};
    made.json["extensionsRequired"] = {"EXT_lights_image_based"};
    auto& light = made.json["extensions"]["EXT_lights_image_based"]["lights"];
    light = json::parse(R"([{"intensity":3,"rotation":[0,1,0,0],"specularImages":[[5,4,3,2,1,0],[6,7,8,9,10,11]],"specularImageSize":4}])");
    EXPECT_FALSE(read_scene(made.document()).sky.is_there) << "no scene asks for it";
    made.json["scenes"][0]["extensions"]["EXT_lights_image_based"]["light"] = 0;
    const SceneRecord record = read_scene(made.document());
    ASSERT_TRUE(record.sky.is_there);
    EXPECT_EQ(record.sky.intensity, 3);
    EXPECT_THAT(record.sky.rotation, ElementsAre(0, 1, 0, 0));
    std::string contents;  // the letter k of the base64 text, as a digit
    for (const ImageRecord& face : record.sky.faces) {
        ASSERT_EQ(face.bytes.size(), 3u);
        contents += static_cast<char>('0' + 4 * (face.bytes[1] - 64) + face.bytes[2] / 64);
    }
    EXPECT_EQ(contents, "543210");
    for (const char* bad : {R"([])", R"([[0,1,2,3,4]])", R"([[0,1,2,3,4,99]])", R"([[0,1,2,3,4,-1]])", R"([7])", R"([[0,1,2,3,4,"x"]])"}) {
        light[0]["specularImages"] = json::parse(bad);
        EXPECT_NE(bad_input_of([&] { read_scene(made.document()); }), "") << bad;
    }
    made.json["scenes"][0]["extensions"]["EXT_lights_image_based"]["light"] = 1;
    EXPECT_NE(bad_input_of([&] { read_scene(made.document()); }), "");
}

TEST(GltfMaterials, FactorsAndExtensions) {
    MadeGltf made;
    made.primitive(made.square())["material"] = 0;
    made.json["materials"] = json::parse(R"([
      {"name":"lamp","emissiveFactor":[1,0.5,0],"doubleSided":true,"alphaMode":"MASK","alphaCutoff":0.25,
       "pbrMetallicRoughness":{"baseColorFactor":[0.1,0.2,0.3,0.4]},
       "extensions":{"KHR_materials_emissive_strength":{"emissiveStrength":100},"KHR_materials_unlit":{},
                     "KHR_materials_transmission":{"transmissionFactor":0.75}}},
      {"extensions":{"KHR_materials_pbrSpecularGlossiness":{"diffuseFactor":[0.5,0.6,0.7,1]},"KHR_materials_clearcoat":{}}},
      {"alphaMode":"ODD","extensions":{"KHR_materials_clearcoat":{}}}])");
    const SceneRecord record = read_scene(made.document());
    EXPECT_THAT(record.materials[0].emission, ElementsAre(100, 50, 0));
    EXPECT_THAT(record.materials[0].base_color, ElementsAre(0.1, 0.2, 0.3, 0.4));
    EXPECT_TRUE(record.materials[0].double_sided);
    EXPECT_TRUE(record.materials[0].unlit);
    EXPECT_EQ(record.materials[0].transmission, 0.75);
    EXPECT_EQ(record.materials[0].alpha_mode, AlphaMode::mask);
    EXPECT_EQ(record.materials[0].alpha_cutoff, 0.25);
    EXPECT_THAT(record.materials[1].base_color, ElementsAre(0.5, 0.6, 0.7, 1));
    EXPECT_EQ(std::ranges::count(record.warnings, std::string("material-extension"), &Warning::code), 2);  // unlit, clearcoat
    EXPECT_TRUE(has_warning(record, "alpha-mode"));
}

TEST(GltfMaterials, TexturesSamplersAndImages) {
    MadeGltf made;
    made.primitive(made.square())["material"] = 0;
    const auto picture = made.view(std::vector<std::uint8_t>{1, 2, 3});
    made.json["images"] = {{{"bufferView", picture}, {"mimeType", "image/png"}},
                           {{"uri", "gone.png"}},
                           {{"uri", "data:image/jpeg;base64,aGVsbG8="}},
                           {{"uri", "unused.png"}}};
    made.json["samplers"] = json::parse(R"([{"wrapS":33071,"wrapT":33648,"magFilter":9728}])");
    made.json["textures"] = json::parse(R"([{"source":0,"sampler":0},{"source":1},
        {"extensions":{"KHR_texture_basisu":{"source":0}}},{"extensions":{"EXT_texture_webp":{"source":2}}},{"source":3}])");
    made.json["materials"] = json::parse(R"([
      {"pbrMetallicRoughness":{"baseColorTexture":{"index":0,"texCoord":0,"extensions":{"KHR_texture_transform":
         {"offset":[0,1],"rotation":1.5707963267948966,"scale":[0.5,0.5],"texCoord":1}}}},"emissiveTexture":{"index":1}},
      {"pbrMetallicRoughness":{"baseColorTexture":{"index":2}},"emissiveTexture":{"index":3}, "normalTexture":{"index":4}}])");
    const SceneRecord record = read_scene(made.document());
    EXPECT_EQ(record.textures[0].wrap_s, WrapMode::clamp);
    EXPECT_EQ(record.textures[0].wrap_t, WrapMode::mirror);
    EXPECT_TRUE(record.textures[0].nearest);
    EXPECT_EQ(record.textures[1].wrap_s, WrapMode::repeat);
    EXPECT_EQ(record.textures[2].image, -1);
    EXPECT_TRUE(has_warning(record, "texture-format"));
    EXPECT_EQ(record.images[0].bytes, (Bytes{1, 2, 3}));
    EXPECT_TRUE(record.images[1].bytes.empty());
    EXPECT_EQ(std::ranges::count(record.warnings, std::string("image-missing"), &Warning::code), 1);  // not the unused one
    EXPECT_EQ(record.images[2].bytes.size(), 5u);
    EXPECT_EQ(record.images[2].mime_type, "image/jpeg");
    // The example of the extension: the unit square must land on the lower left quadrant of the image.
    const TextureUse& use = record.materials[0].base_color_texture;
    EXPECT_EQ(use.uv_set, 1);
    for (const auto& [u, v] : {std::pair{0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}, {1.0, 1.0}}) {
        const double x = use.transform[0] * u + use.transform[1] * v + use.transform[2];
        const double y = use.transform[3] * u + use.transform[4] * v + use.transform[5];
        EXPECT_NEAR(x, 0.5 * v, 1e-12);
        EXPECT_NEAR(y, 1 - 0.5 * u, 1e-12);
    }
}

TEST(GltfMaterials, WrongIndicesAreErrors) {
    MadeGltf made;
    made.primitive(made.square())["material"] = 3;
    EXPECT_THAT(bad_input_of([&] { read_scene(made.document()); }), HasSubstr("\"material\" is 3"));
    made.json["meshes"][0]["primitives"][0]["material"] = 0;
    made.json["materials"] = json::parse(R"([{"emissiveTexture":{"index":5}}])");
    EXPECT_THAT(bad_input_of([&] { read_scene(made.document()); }), HasSubstr("\"index\" is 5"));
    made.json["materials"] = json::parse(R"([{"emissiveFactor":[1,2]}])");
    EXPECT_THAT(bad_input_of([&] { read_scene(made.document()); }), HasSubstr("array of 3 numbers"));
}

TEST(GltfScene, RestPoseIsNamed) {
    MadeGltf made;
    made.primitive(made.square())["targets"] = json::parse(R"([{"POSITION":0}])");
    made.json["skins"] = json::parse(R"([{"joints":[0]}])");
    made.json["animations"] = json::parse(R"([{"channels":[],"samplers":[]}])");
    made.json["nodes"][0]["skin"] = 0;
    const SceneRecord record = read_scene(made.document());
    for (const char* code : {"skinned-rest-pose", "morph-rest-pose", "animation-rest-pose"})
        EXPECT_TRUE(has_warning(record, code)) << code;
}

TEST(GltfScene, EmptyFileIsAnEmptyScene) {
    const SceneRecord record = read_scene(MadeGltf().document());
    EXPECT_TRUE(record.instances.empty());
    EXPECT_TRUE(record.meshes.empty());
}

}  // namespace
}  // namespace luxel
