#include "baker/scene/scene_build.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "baker/core/parallel.h"
#include "baker/core/units.h"
#include "baker/scene/texture_sample.h"

namespace luxel {
namespace {

using testing::ElementsAre;

/// One quad in z = 0 facing +Z, shown once.
SceneRecord quad_record() {
    PrimitiveRecord quad;
    quad.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    quad.normals.assign(4, Vec3f(0, 0, 1));
    quad.uv[0] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    quad.indices = {0, 1, 2, 0, 2, 3};
    SceneRecord record;
    record.meshes.push_back({"quad", {quad}});
    record.instances.push_back({.node = 0, .mesh = 0, .node_path = "/quad", .world = Matrix44d()});
    return record;
}

struct Built {
    std::vector<Warning> warnings;
    Scene scene;
    explicit Built(const SceneRecord& record, const ImageDecoder& decode = {}, const BuildOptions& options = {}) {
        scene = build_scene(record, decode, options, warnings);
    }
    [[nodiscard]] std::ptrdiff_t count(const std::string& code) const {
        return std::ranges::count(warnings, code, &Warning::code);
    }
};

Vec3f total_area(const Scene& scene) {
    Vec3d sum(0, 0, 0);
    for (std::uint32_t t = 0; t < scene.triangle_count(); ++t) sum += scene.area_vector(t) * 0.5;
    return to_float(sum);
}

Matrix44d scaled(double x, double y, double z) {
    Matrix44d m;
    m[0][0] = x;
    m[1][1] = y;
    m[2][2] = z;
    return m;
}

TEST(SceneBuild, PlainQuad) {
    const Built built(quad_record());
    EXPECT_TRUE(built.warnings.empty());
    ASSERT_EQ(built.scene.objects.size(), 1u);
    EXPECT_EQ(built.scene.positions.size(), 4u);
    EXPECT_EQ(built.scene.objects[0].name, "/quad, primitive 0");
    EXPECT_EQ(built.scene.objects[0].material, 0u);  // the default one, as the file has none
    EXPECT_EQ(total_area(built.scene), Vec3f(0, 0, 1));
    EXPECT_EQ(built.scene.geometric_normal(0), Vec3f(0, 0, 1));
    EXPECT_FALSE(built.scene.object_has_uv1[0]);
    EXPECT_GT(built.scene.resident_bytes(), 4 * sizeof(Vec3f));
}

TEST(SceneBuild, MirroredInstancesKeepTheirFront) {
    SceneRecord record = quad_record();
    record.instances[0].world = scaled(-2, 3, 1);
    const Built built(record);
    EXPECT_TRUE(built.scene.objects[0].mirrored);
    EXPECT_EQ(total_area(built.scene), Vec3f(0, 0, 6));
    for (const Vec3f& n : built.scene.normals) EXPECT_EQ(n, Vec3f(0, 0, 1));
    // A mirrored z turns the quad's front to -Z, and the shading normal with it.
    record.instances[0].world = scaled(1, 1, -1);
    const Built turned(record);
    EXPECT_EQ(total_area(turned.scene), Vec3f(0, 0, -1));
    EXPECT_EQ(turned.scene.normals[0], Vec3f(0, 0, -1));
}

TEST(SceneBuild, NormalsUseTheInverseTranspose) {
    SceneRecord record = quad_record();
    PrimitiveRecord& quad = record.meshes[0].primitives[0];
    quad.positions = {{0, 0, 0}, {1, 0, 1}, {1, 1, 1}, {0, 1, 0}};
    quad.normals.assign(4, Vec3f(-1, 0, 1) * 1e-20f);  // direction counts, length does not
    record.instances[0].world = scaled(1e-3, 5, 40);
    const Built built(record);
    for (const Vec3f& n : built.scene.normals) EXPECT_NEAR((n - built.scene.geometric_normal(0)).length(), 0, 1e-6);
}

TEST(SceneBuild, FlatScaleStillHasANormal) {
    SceneRecord record = quad_record();
    record.instances[0].world = scaled(1, 1, 0);
    const Built built(record);
    EXPECT_EQ(built.scene.normals[0], Vec3f(0, 0, 1));
    record.instances[0].world = scaled(1, 0, 1);
    const Built gone(record);
    EXPECT_EQ(gone.scene.triangle_count(), 0u);
    EXPECT_TRUE(gone.scene.objects.empty());
    EXPECT_EQ(gone.count("dropped-triangles"), 1);
}

TEST(SceneBuild, WithoutNormalsEveryTriangleIsFlat) {
    SceneRecord record = quad_record();
    PrimitiveRecord& quad = record.meshes[0].primitives[0];
    quad.normals.clear();
    quad.positions[3] = {0, 1, 1};
    const Built built(record);
    ASSERT_EQ(built.scene.positions.size(), 6u);
    for (std::uint32_t t = 0; t < 2; ++t)
        for (int k = 0; k < 3; ++k)
            EXPECT_EQ(built.scene.normals[3 * t + static_cast<std::uint32_t>(k)], built.scene.geometric_normal(t));
    EXPECT_EQ(built.scene.uv[0][5], Vec2f(0, 1));
}

TEST(SceneBuild, BadNormalsBecomeGeometricOnes) {
    SceneRecord record = quad_record();
    const float nan = std::numeric_limits<float>::quiet_NaN();
    record.meshes[0].primitives[0].normals = {{0, 0, 0}, {nan, 0, 1}, {0, 0, 1}, {0, 0, 2}};
    const Built built(record);
    for (const Vec3f& n : built.scene.normals) EXPECT_EQ(n, Vec3f(0, 0, 1));
    EXPECT_EQ(built.count("bad-normals"), 1);
}

TEST(SceneBuild, BadTrianglesAreDroppedAndCountedOnce) {
    SceneRecord record = quad_record();
    PrimitiveRecord& quad = record.meshes[0].primitives[0];
    const float inf = std::numeric_limits<float>::infinity();
    quad.positions.insert(quad.positions.end(), {{inf, 0, 0}, {3, 3, 3}});  // one bad, one that nothing uses
    quad.normals.resize(6, Vec3f(0, 0, 1));
    quad.uv[0].resize(6);
    quad.uv[0][1] = {inf, 0};
    quad.indices = {0, 0, 1, 0, 1, 4, 0, 1, 2, 0, 2, 3};
    const Built built(record);
    EXPECT_EQ(built.scene.triangle_count(), 2u);
    EXPECT_EQ(built.scene.positions.size(), 4u);
    EXPECT_THAT(built.scene.source_triangle, ElementsAre(2u, 3u));
    EXPECT_EQ(built.count("dropped-triangles"), 1);
    EXPECT_EQ(built.count("bad-uv"), 1);
    for (const Vec2f& uv : built.scene.uv[0]) EXPECT_TRUE(std::isfinite(uv.x));
}

TEST(SceneBuild, FarFromTheOriginNothingIsLost) {
    SceneRecord record = quad_record();
    record.instances[0].world[3][0] = 1e9 + 0.25;
    record.instances[0].world[3][2] = -3e8;
    const Built built(record);
    EXPECT_EQ(total_area(built.scene), Vec3f(0, 0, 1));
    const Vec3d corner = built.scene.origin + to_double(built.scene.positions[0]);
    EXPECT_EQ(corner, Vec3d(1e9 + 0.25, 0, -3e8));
}

TEST(SceneBuild, OriginStaysWhenSomethingInsideMoves) {
    SceneRecord record = quad_record();
    record.instances[0].world = scaled(100, 100, 1);
    record.instances.push_back({.node = 1, .mesh = 0, .node_path = "/small", .world = Matrix44d()});
    const Vec3d before = Built(record).scene.origin;
    record.instances[1].world[3][0] = 50;
    EXPECT_EQ(Built(record).scene.origin, before);
    record.instances[0].world = scaled(101, 100.5, 1);
    EXPECT_EQ(Built(record).scene.origin, before);
}

TEST(SceneBuild, HashesFollowPathAndContent) {
    SceneRecord record = quad_record();
    record.instances.push_back({.node = 1, .mesh = 0, .node_path = "/other", .world = scaled(2, 2, 2)});
    const Scene a = Built(record).scene;
    EXPECT_NE(a.objects[0].path_hash, a.objects[1].path_hash);
    EXPECT_EQ(a.objects[0].content_hash, a.objects[1].content_hash);
    std::swap(record.instances[0], record.instances[1]);
    const Scene b = Built(record).scene;
    EXPECT_EQ(a.objects[0].path_hash, b.objects[1].path_hash);
    record.meshes[0].primitives[0].positions[2].z = 0.5f;
    EXPECT_NE(Built(record).scene.objects[0].content_hash, a.objects[0].content_hash);
}

TEST(SceneBuild, KeysTellGeometryFromLight) {
    SceneRecord record = quad_record();
    record.materials.resize(1);
    record.meshes[0].primitives[0].material = 0;
    record.lamps.push_back({.kind = LampKind::point, .node_path = "/lamp", .intensity = {1, 1, 1}, .world = Matrix44d()});
    const Scene base = Built(record).scene;
    EXPECT_EQ(Built(record).scene.geometry_key, base.geometry_key);
    EXPECT_EQ(Built(record).scene.light_key, base.light_key);
    const auto expect_changed = [&](const SceneRecord& changed, bool geometry, bool light) {
        const Scene scene = Built(changed).scene;
        EXPECT_EQ(scene.geometry_key != base.geometry_key, geometry);
        EXPECT_EQ(scene.light_key != base.light_key, light);
    };
    SceneRecord red = record, bright = record, lamp = record, sided = record, moved = record;
    red.materials[0].base_color[1] = 0.5;
    expect_changed(red, false, true);
    bright.materials[0].emission = {5, 5, 5};
    expect_changed(bright, false, true);
    lamp.lamps[0].intensity[0] = 2;
    expect_changed(lamp, false, true);
    sided.materials[0].double_sided = true;
    expect_changed(sided, true, false);
    moved.instances[0].world[3][1] = 0.125;
    expect_changed(moved, true, false);
}

TEST(SceneBuild, MaterialsInPhysicalUnits) {
    SceneRecord record = quad_record();
    record.materials.resize(2);
    record.materials[0].name = "odd";
    record.materials[0].base_color = {1.5, -0.5, std::nan(""), 0.5};
    record.materials[0].emission = {10, -1, std::numeric_limits<double>::infinity()};
    record.materials[1].transmission = 0.25;
    record.meshes[0].primitives[0].material = 0;
    const Built built(record);
    ASSERT_EQ(built.scene.materials.size(), 3u);
    const Material& odd = built.scene.materials[0];
    EXPECT_EQ(odd.reflectance, Rgb(1, 0, 0));
    EXPECT_EQ(odd.alpha, 0.5f);
    EXPECT_EQ(odd.emission, Rgb(static_cast<float>(10 * pi), 0, 0));
    EXPECT_EQ(built.count("reflectance-clamped"), 1);
    EXPECT_EQ(built.count("emission-clamped"), 1);
    EXPECT_EQ(built.scene.materials[1].reflectance, Rgb(1, 1, 1));
    EXPECT_EQ(built.scene.materials[1].transmission, 0.25f);
    EXPECT_EQ(built.count("transmission-blocked"), 0);  // nothing shows that material
}

TEST(SceneBuild, BadValuesAreNamedAndClamped) {
    SceneRecord record = quad_record();
    record.materials.resize(1);
    record.materials[0].name = "odd";
    record.materials[0].base_color = {1.5, 0.25, 0, 1};
    record.materials[0].emission = {1e31, -2, 1e308 * 10};
    record.materials[0].metallic = 1.25;
    record.meshes[0].primitives[0].material = 0;
    const Built built(record);
    ASSERT_EQ(built.warnings.size(), 4u);
    for (const Warning& warning : built.warnings) EXPECT_EQ(warning.where, "material \"odd\"");
    EXPECT_EQ(built.warnings[0].text, "baseColorFactor is (1.5, 0.25, 0), expected 0 to 1: (1, 0.25, 0) is used");
    EXPECT_EQ(built.warnings[1].text,
              "emissiveFactor times emissiveStrength is (1e+31, -2, inf), expected 0 to 1e+30: (1e+30, 0, 0) is used");
    EXPECT_EQ(built.warnings[2].text, "metallicFactor is 1.25, expected 0 to 1: 1 is used");
    EXPECT_EQ(built.warnings[3].code, "metal-mirrors");
    EXPECT_EQ(built.scene.materials[0].emission, Rgb(static_cast<float>(pi * 1e30), 0, 0));
}

TEST(SceneBuild, BadValuesAreNamedAndRefused) {
    const BuildOptions refuse{.bad_values = BadValues::refuse, .file = "hall.glb"};
    const double infinity = std::numeric_limits<double>::infinity();
    const auto expect_refused = [&](const SceneRecord& record, const std::string& where, const std::string& what) {
        try {
            const Built built(record, {}, refuse);
            ADD_FAILURE() << "accepted: " << what;
        } catch (const Error& error) {
            EXPECT_EQ(error.code, ErrorCode::bad_input);
            EXPECT_EQ(error.where, where);
            EXPECT_EQ(error.what_text, what);
        }
    };
    SceneRecord good = quad_record();
    good.materials.resize(2);
    good.materials[0].name = "odd";
    good.materials[1].base_color = {2, 2, 2, 2};  // nothing shows this one
    good.meshes[0].primitives[0].material = 0;
    EXPECT_TRUE(Built(good, {}, refuse).warnings.empty());

    SceneRecord record = good;
    record.materials[0].base_color[1] = std::nan("");
    expect_refused(record, "hall.glb: material \"odd\"", "baseColorFactor is (1, nan, 1), expected 0 to 1");
    record = good;
    record.materials[0].emission = {0, infinity, -1};
    expect_refused(record, "hall.glb: material \"odd\"",
                   "emissiveFactor times emissiveStrength is (0, inf, -1), expected 0 to 1e+30");
    record = good;
    record.materials[0].emissive_texture.transform[2] = infinity;
    expect_refused(record, "hall.glb: material \"odd\"", "the transform of emissiveTexture is not finite");
    record = good;
    record.lamps.push_back({.kind = LampKind::point, .node_path = "/sun", .intensity = {1, -2, 3}, .world = Matrix44d()});
    expect_refused(record, "hall.glb: lamp /sun", "color times intensity is (1, -2, 3), expected 0 to 1e+30");
}

TEST(SceneBuild, ATextureCannotMakeTheBrightestLightEndless) {
    SceneRecord record = quad_record();
    record.images.resize(1);
    record.images[0].bytes = {1};
    record.textures = {{.image = 0}};
    record.materials.resize(1);
    record.materials[0].emission = {1e30, 1e30, 1e30};
    record.materials[0].emissive_texture.texture = 0;
    record.meshes[0].primitives[0].material = 0;
    const float infinity = std::numeric_limits<float>::infinity();
    const Built built(record, [&](ByteView, const std::string&) {
        return std::optional(DecodedImage{1, 1, {{infinity, std::nanf(""), -1.0f, 1.0f}}});
    });
    EXPECT_EQ(surface_emission(built.scene, 0, 0.2f, 0.2f), Rgb(static_cast<float>(pi * 1e30), 0, 0));
}

TEST(SceneBuild, ExtremeEmissionSurvives) {
    SceneRecord record = quad_record();
    record.materials.resize(1);
    record.meshes[0].primitives[0].material = 0;
    record.materials[0].emission = {1e-30, 1e30, 0};
    const Built built(record);
    EXPECT_TRUE(built.warnings.empty());
    EXPECT_FLOAT_EQ(built.scene.materials[0].emission.x, static_cast<float>(pi * 1e-30));
    EXPECT_FLOAT_EQ(built.scene.materials[0].emission.y, static_cast<float>(pi * 1e30));
}

SceneRecord textured_record() {
    SceneRecord record = quad_record();
    record.images.resize(3);
    for (ImageRecord& image : record.images) image.bytes = {1};
    record.images[0].name = "a";
    record.images[1].name = "broken";
    record.images[2].name = "unused";
    TextureRecord clamp{.image = 0, .wrap_s = WrapMode::clamp};
    record.textures = {{.image = 0}, {.image = 0}, clamp, {.image = 1}, {.image = 2}, {.image = -1}};
    record.materials.resize(4);
    for (int m = 0; m < 4; ++m) {
        auto& primitives = record.meshes[0].primitives;
        if (m > 0 && m < 3) primitives.push_back(primitives[0]);
        if (m < 3) primitives[static_cast<std::size_t>(m)].material = m;
    }
    record.materials[0].base_color_texture.texture = 0;
    record.materials[0].emissive_texture.texture = 1;
    record.materials[0].emission = {1, 1, 1};
    record.materials[1].base_color_texture.texture = 2;
    record.materials[1].emissive_texture.texture = 4;  // emits nothing: not decoded
    record.materials[2].base_color_texture.texture = 3;
    record.materials[3].base_color_texture.texture = 4;  // material that nothing shows
    return record;
}

TEST(SceneBuild, TexturesAreDecodedOnceAndLinear) {
    std::vector<std::string> decoded;
    const ImageDecoder decode = [&](ByteView, const std::string& name) -> std::optional<DecodedImage> {
        decoded.push_back(name);
        if (name == "broken") return std::nullopt;
        return DecodedImage{2, 1, {{0.0f, 128.0f / 255.0f, 1.0f, 128.0f / 255.0f}, {0.3f, 0.04f, 2.0f, -1.0f}}};
    };
    const Built built(textured_record(), decode);
    EXPECT_THAT(decoded, ElementsAre("a", "broken"));
    ASSERT_EQ(built.scene.textures.size(), 2u);
    const auto& materials = built.scene.materials;
    EXPECT_EQ(materials[0].base_texture, 0u);
    EXPECT_EQ(materials[0].emissive_texture, 0u);
    EXPECT_EQ(materials[1].base_texture, 1u);
    EXPECT_EQ(materials[1].emissive_texture, none);
    EXPECT_EQ(materials[2].base_texture, none);
    EXPECT_EQ(built.scene.textures[1].wrap_s, WrapMode::clamp);
    EXPECT_EQ(built.count("image-undecoded"), 1);
    const auto& pixels = built.scene.textures[0].pixels;
    EXPECT_NEAR(pixels[0][1], 0.215861, 1e-5);  // sRGB 128
    EXPECT_EQ(pixels[0][2], 1.0f);
    EXPECT_EQ(pixels[0][3], 128.0f / 255.0f);  // alpha has no curve
    EXPECT_NEAR(pixels[1][0], 0.0732389, 1e-6);
    EXPECT_NEAR(pixels[1][1], 0.04 / 12.92, 1e-7);
    EXPECT_EQ(pixels[1][2], 1.0f);
    EXPECT_EQ(pixels[1][3], 0.0f);
}

TEST(SceneBuild, ThePictureBesideOneThatCannotBeDecodedIsTaken) {
    SceneRecord record = textured_record();
    std::size_t broken = 0;
    while (record.images[broken].name != "broken") ++broken;
    for (TextureRecord& texture : record.textures)
        if (texture.image == static_cast<int>(broken)) texture.other = 0;
    const ImageDecoder decode = [](ByteView, const std::string& name) -> std::optional<DecodedImage> {
        if (name == "broken") return std::nullopt;
        return DecodedImage{2, 1, {{1.0f, 0.0f, 0.0f, 1.0f}, {0.0f, 1.0f, 0.0f, 1.0f}}};
    };
    const Built built(record, decode);
    ASSERT_NE(built.scene.materials[2].base_texture, none);
    EXPECT_EQ(built.scene.textures[built.scene.materials[2].base_texture].pixels[0], (Rgba{1, 0, 0, 1}));
    EXPECT_EQ(built.count("image-undecoded"), 1);
    const auto said = std::ranges::find(built.warnings, std::string("image-undecoded"), &Warning::code);
    EXPECT_NE(said->text.find("the picture beside it is taken"), std::string::npos) << said->text;
}

TEST(SceneBuild, TexturesWithoutCoordinatesAreNamed) {
    SceneRecord record = textured_record();
    record.materials[0].base_color_texture.uv_set = 1;
    record.materials[1].base_color_texture.uv_set = 5;
    const ImageDecoder decode = [](ByteView, const std::string&) { return DecodedImage{2, 1, {{0.5f, 0.5f, 0.5f, 1.0f}, {1, 1, 1, 1}}}; };
    const Built built(record, decode);
    EXPECT_EQ(built.count("no-uv"), 1);
    EXPECT_EQ(built.count("uv-set"), 1);
    EXPECT_EQ(built.scene.materials[1].base_texture, none);
}

/// Decodes to one colour: sRGB 128, and 64 of alpha.
std::optional<DecodedImage> even_picture(ByteView, const std::string&) {
    return DecodedImage{2, 2, std::vector<std::array<float, 4>>(4, {128.0f / 255.0f, 1.0f, 0.0f, 64.0f / 255.0f})};
}

TEST(SceneBuild, TexturesOfOneColourGoIntoTheirMaterial) {
    SceneRecord record = textured_record();
    record.materials[0].base_color = {0.5, 0.5, 0.5, 0.5};
    record.materials[0].alpha_mode = AlphaMode::blend;
    const Built folded(record, even_picture), kept(record, even_picture, {.keep_even_textures = true});
    const Material& material = folded.scene.materials[0];
    EXPECT_EQ(material.base_texture, none);
    EXPECT_EQ(material.emissive_texture, none);
    EXPECT_NE(kept.scene.materials[0].base_texture, none);
    EXPECT_GE(folded.scene.even_textures, 2u);
    EXPECT_EQ(kept.scene.even_textures, 0u);
    for (const Texture& texture : folded.scene.textures) EXPECT_TRUE(texture.pixels.empty()) << "nothing looks it up";
    // As bits: a sample of equal pixels is that pixel.
    EXPECT_EQ(surface_reflectance(folded.scene, 0, 0.3f, 0.3f), surface_reflectance(kept.scene, 0, 0.3f, 0.3f));
    EXPECT_EQ(surface_emission(folded.scene, 0, 0.3f, 0.3f), surface_emission(kept.scene, 0, 0.3f, 0.3f));
    EXPECT_EQ(surface_alpha(folded.scene, 0, 0.3f, 0.3f), surface_alpha(kept.scene, 0, 0.3f, 0.3f));
    EXPECT_NEAR(material.reflectance.x, 0.5 * 0.215861, 1e-6);
    EXPECT_EQ(material.alpha, 0.5f * (64.0f / 255.0f));
}

TEST(SceneBuild, OfLampsWithoutPowerTheNamesAreKept) {
    SceneRecord record = quad_record();
    record.lamps = {{.kind = LampKind::point, .node_path = "/off", .intensity = {0, 0, 0}, .world = Matrix44d()},
                    {.kind = LampKind::point, .node_path = "/on", .intensity = {0, 1, 0}, .world = Matrix44d()}};
    const Built built(record), all(record, {}, {.keep_dark_lamps = true});
    ASSERT_EQ(built.scene.lamps.size(), 1u);
    EXPECT_EQ(built.scene.lamps[0].name, "/on");
    EXPECT_THAT(built.scene.dark_lamps, ElementsAre("/off"));
    EXPECT_EQ(all.scene.lamps.size(), 2u);
}

TEST(SceneBuild, Lamps) {
    SceneRecord record = quad_record();
    record.instances[0].world[3][0] = 1000;
    LampRecord spot{.kind = LampKind::spot, .node_path = "/spot", .intensity = {3, -1, 0}, .inner_cone = 0.5, .outer_cone = 0.25,
                    .world = scaled(2, 2, 2)};
    spot.world[3][0] = 1001;
    LampRecord lost = spot;
    lost.world[3][0] = std::nan("");
    LampRecord flat = spot;
    flat.world = scaled(1, 1, 0);
    record.lamps = {spot, lost, flat};
    const Built built(record);
    ASSERT_EQ(built.scene.lamps.size(), 1u);
    const Lamp& lamp = built.scene.lamps[0];
    EXPECT_EQ(built.scene.origin + to_double(lamp.position), Vec3d(1001, 0, 0));
    EXPECT_EQ(lamp.direction, Vec3f(0, 0, -1));
    EXPECT_EQ(lamp.intensity, Rgb(3, 0, 0));
    EXPECT_GE(lamp.cos_inner, lamp.cos_outer);
    EXPECT_EQ(built.count("lamp-clamped"), 1);
    EXPECT_EQ(built.count("lamp-cone"), 1);
    EXPECT_EQ(built.count("lamp-skipped"), 2);
}

TEST(SceneBuild, EmptyRecordIsAnEmptyScene) {
    const Built built{SceneRecord()};
    EXPECT_EQ(built.scene.triangle_count(), 0u);
    EXPECT_EQ(built.scene.origin, Vec3d(0, 0, 0));
}

TEST(SceneBuild, SameBytesForAnyThreadCount) {
    SceneRecord record = quad_record();
    for (int i = 1; i < 200; ++i) {
        record.instances.push_back({.node = i, .mesh = 0, .node_path = "/q" + std::to_string(i), .world = scaled(i, 1, -i)});
        record.instances.back().world[3][1] = 0.1 * i;
    }
    Key keys[2];
    for (unsigned threads : {1u, 2u}) {
        const ThreadLimit limit(threads);
        keys[threads - 1] = Built(record).scene.geometry_key;
    }
    EXPECT_EQ(keys[0], keys[1]);
}

}  // namespace
}  // namespace luxel
