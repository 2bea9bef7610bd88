/// What extensions of materials and textures mean for the light, and what stands in for what cannot be read.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "formats/gltf/gltf_in.h"
#include "tests/unit/gltf/made_gltf.h"

namespace luxel {
namespace {

using nlohmann::json;
using test::MadeGltf;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

MadeGltf square_of(const json& materials) {
    MadeGltf made;
    auto& primitive = made.primitive(made.square());
    primitive["mode"] = 5;
    primitive["material"] = 0;
    made.json["materials"] = materials;
    return made;
}

std::ptrdiff_t count(const SceneRecord& record, const std::string& code) { return std::ranges::count(record.warnings, code, &Warning::code); }

TEST(GltfExtensions, VariantsShowTheMaterialOfThePrimitive) {
    MadeGltf made = square_of(json::parse(R"([{"name":"own"},{"name":"red"},{"name":"blue"}])"));
    made.json["extensionsUsed"] = made.json["extensionsRequired"] = {"KHR_materials_variants"};
    made.json["extensions"]["KHR_materials_variants"]["variants"] = json::parse(R"([{"name":"a"},{"name":"b"}])");
    made.json["meshes"][0]["primitives"][0]["extensions"]["KHR_materials_variants"]["mappings"] =
        json::parse(R"([{"material":1,"variants":[0]},{"material":2,"variants":[1]}])");
    const SceneRecord record = read_scene(made.document());
    EXPECT_EQ(record.meshes[0].primitives[0].material, 0);
    EXPECT_TRUE(record.warnings.empty());
}

TEST(GltfExtensions, SpecularGlossinessIsItsDiffusePart) {
    MadeGltf made = square_of(json::parse(R"([{"pbrMetallicRoughness":{"baseColorFactor":[0,0,0,1],"metallicFactor":1,"baseColorTexture":{"index":0}},
        "extensions":{"KHR_materials_pbrSpecularGlossiness":{"diffuseFactor":[0.5,0.6,0.7,0.8],"diffuseTexture":{"index":1,"texCoord":1},
                                                             "specularFactor":[1,1,1]}}},
       {"pbrMetallicRoughness":{"baseColorFactor":[0,0,0,1]},"extensions":{"KHR_materials_pbrSpecularGlossiness":{}}}])"));
    made.json["textures"] = json::parse(R"([{"source":0},{"source":0}])");
    made.json["images"] = json::parse(R"([{"uri":"data:image/png;base64,aGVsbG8="}])");
    const SceneRecord record = read_scene(made.document());
    EXPECT_THAT(record.materials[0].base_color, ElementsAre(0.5, 0.6, 0.7, 0.8));
    EXPECT_EQ(record.materials[0].base_color_texture.texture, 1);
    EXPECT_EQ(record.materials[0].base_color_texture.uv_set, 1);
    EXPECT_EQ(record.materials[0].metallic, 0);
    EXPECT_THAT(record.materials[1].base_color, ElementsAre(1, 1, 1, 1)) << "the default of the extension";
    EXPECT_TRUE(record.warnings.empty());
}

TEST(GltfExtensions, UnlitReflectsItsBaseColour) {
    const SceneRecord record = read_scene(square_of(json::parse(R"([{"pbrMetallicRoughness":{"baseColorFactor":[0.5,0.25,1,1],"metallicFactor":1},
        "extensions":{"KHR_materials_unlit":{}}}])")).document());
    EXPECT_THAT(record.materials[0].base_color, ElementsAre(0.5, 0.25, 1, 1));
    EXPECT_EQ(record.materials[0].metallic, 0) << "it mirrors nothing";
    EXPECT_THAT(record.materials[0].emission, ElementsAre(0, 0, 0));
}

/// A texture with these members, used by the material.
SceneRecord read_texture(const json& texture) {
    MadeGltf made = square_of(json::parse(R"([{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}])"));
    made.json["textures"] = json::array({texture});
    made.json["images"] = json::parse(R"([{"uri":"data:image/png;base64,aGVsbG8="},{"uri":"data:image/webp;base64,aGVsbG8h"},{"uri":"gone.webp"}])");
    return read_scene(made.document());
}

TEST(GltfExtensions, BasisuHasThePictureBesideItOrNone) {
    const SceneRecord beside = read_texture(json::parse(R"({"source":0,"extensions":{"KHR_texture_basisu":{"source":1}}})"));
    EXPECT_EQ(beside.textures[0].image, 0);
    EXPECT_TRUE(beside.warnings.empty());
    const SceneRecord alone = read_texture(json::parse(R"({"extensions":{"KHR_texture_basisu":{"source":1}}})"));
    EXPECT_EQ(alone.textures[0].image, -1);
    ASSERT_EQ(count(alone, "texture-format"), 1);
    EXPECT_THAT(alone.warnings[0].text, AllOf(HasSubstr("KHR_texture_basisu"), HasSubstr("counts as white")));
}

TEST(GltfExtensions, WebpIsTakenBeforeThePictureBesideIt) {
    const SceneRecord both = read_texture(json::parse(R"({"source":0,"extensions":{"EXT_texture_webp":{"source":1}}})"));
    EXPECT_EQ(both.textures[0].image, 1);
    EXPECT_EQ(both.textures[0].other, 0);
    EXPECT_EQ(both.images[0].bytes.size(), 5u);
    EXPECT_EQ(both.images[1].bytes.size(), 6u);
    EXPECT_TRUE(both.warnings.empty());
    const SceneRecord gone = read_texture(json::parse(R"({"source":0,"extensions":{"EXT_texture_webp":{"source":2}}})"));
    ASSERT_EQ(count(gone, "image-missing"), 1);
    EXPECT_THAT(gone.warnings[0].text, HasSubstr("the picture beside it is taken"));
    const SceneRecord alone = read_texture(json::parse(R"({"extensions":{"EXT_texture_webp":{"source":1}}})"));
    EXPECT_EQ(alone.textures[0].image, 1);
    EXPECT_EQ(alone.textures[0].other, -1);
}

TEST(GltfExtensions, UnknownOnesAreErrorsWhereRequiredAndNotesWhereUsed) {
    for (const std::string name : {"VENDOR_secret", "KHR_materials_invented", "EXT_texture_avif"}) {
        MadeGltf made = square_of(json::parse("[{}]"));
        made.json["extensionsUsed"] = {name};
        const GltfDocument document = made.document();
        ASSERT_EQ(document.warnings.size(), 1u);
        EXPECT_THAT(document.warnings[0].text, HasSubstr(name));
        made.json["extensionsRequired"] = {name};
        EXPECT_THAT(test::bad_input_of([&] { (void)made.document(); }), AllOf(HasSubstr("made.glb"), HasSubstr(name)));
    }
}

}  // namespace
}  // namespace luxel
