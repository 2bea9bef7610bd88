#include "baker/scene/texture_sample.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace luxel {
namespace {

/// 4 x 2 pixels; red counts columns 0..3, green rows 0..1, alpha 1 on the left half.
Texture ramp(WrapMode wrap, bool nearest = false) {
    Texture texture;
    texture.width = 4;
    texture.height = 2;
    for (int y = 0; y < 2; ++y)
        for (int x = 0; x < 4; ++x)
            texture.pixels.push_back({static_cast<float>(x), static_cast<float>(y), 0.5f, x < 2 ? 1.0f : 0.0f});
    texture.wrap_s = texture.wrap_t = wrap;
    texture.nearest = nearest;
    return texture;
}

float red(const Texture& texture, float u, float v = 0.25f) { return sample_texture(texture, {u, v})[0]; }

TEST(TextureSample, CentersAndHalfway) {
    for (const WrapMode wrap : {WrapMode::repeat, WrapMode::clamp, WrapMode::mirror}) {
        const Texture texture = ramp(wrap);
        for (int x = 0; x < 4; ++x) EXPECT_FLOAT_EQ(red(texture, (static_cast<float>(x) + 0.5f) / 4), static_cast<float>(x));
        EXPECT_FLOAT_EQ(red(texture, 0.5f), 1.5f);
        EXPECT_FLOAT_EQ(sample_texture(texture, {0.5f, 0.5f})[1], 0.5f);
    }
}

TEST(TextureSample, WrapModes) {
    EXPECT_FLOAT_EQ(red(ramp(WrapMode::repeat), 0.0f), 1.5f);  // between the last and the first column
    EXPECT_FLOAT_EQ(red(ramp(WrapMode::repeat), -0.125f), 3.0f);
    EXPECT_FLOAT_EQ(red(ramp(WrapMode::repeat), 10000.125f), 0.0f);
    EXPECT_FLOAT_EQ(red(ramp(WrapMode::clamp), 0.0f), 0.0f);
    EXPECT_FLOAT_EQ(red(ramp(WrapMode::clamp), -1e30f), 0.0f);
    EXPECT_FLOAT_EQ(red(ramp(WrapMode::clamp), 1e30f), 3.0f);
    EXPECT_FLOAT_EQ(red(ramp(WrapMode::mirror), 1.125f), 3.0f);
    EXPECT_FLOAT_EQ(red(ramp(WrapMode::mirror), -0.375f), 1.0f);
    EXPECT_FLOAT_EQ(red(ramp(WrapMode::mirror), 1.0f), 3.0f);
    EXPECT_TRUE(std::isfinite(red(ramp(WrapMode::repeat), 1e30f)));
}

TEST(TextureSample, Nearest) {
    const Texture texture = ramp(WrapMode::repeat, true);
    EXPECT_EQ(red(texture, 0.49f), 1.0f);
    EXPECT_EQ(red(texture, 0.51f), 2.0f);
    EXPECT_EQ(red(texture, 1.0f), 0.0f);
    EXPECT_EQ(red(ramp(WrapMode::clamp, true), 1.0f), 3.0f);
    EXPECT_EQ(red(ramp(WrapMode::mirror, true), 1.0f), 3.0f);
}

TEST(TextureSample, WithoutPixelsOrPlaceItIsWhite) {
    EXPECT_EQ(sample_texture(Texture{}, {0, 0}), (Rgba{1, 1, 1, 1}));
    EXPECT_EQ(sample_texture(ramp(WrapMode::repeat), {std::numeric_limits<float>::quiet_NaN(), 0}), (Rgba{1, 1, 1, 1}));
}

TEST(TextureSample, MeanOverAFootprint) {
    const Texture texture = ramp(WrapMode::repeat);
    // The whole picture: the mean of all pixels.
    const Rgba mean = sample_texture_mean(texture, {0.5f, 0.5f}, {1, 0}, {0, 1});
    EXPECT_FLOAT_EQ(mean[0], 1.5f);
    EXPECT_FLOAT_EQ(mean[1], 0.5f);
    EXPECT_FLOAT_EQ(mean[3], 0.5f);
    // A point is a sample.
    EXPECT_EQ(sample_texture_mean(texture, {0.3f, 0.4f}, {0, 0}, {0, 0}), sample_texture(texture, {0.3f, 0.4f}));
    // A footprint of thousands of periods is near the mean all the same, at bounded cost.
    const Rgba far = sample_texture_mean(texture, {0.5f, 0.5f}, {1e6f, 0}, {0, 1e6f});
    for (const float channel : far) EXPECT_TRUE(std::isfinite(channel));
}

/// One triangle with uv = (b1, b2) and a texture of all roles.
Scene textured_scene() {
    Scene scene;
    scene.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    scene.normals.assign(3, Vec3f(0, 0, 1));
    scene.uv[0] = {{0, 0}, {1, 0}, {0, 1}};
    scene.uv[1] = {{0, 0}, {0, 0}, {0, 0}};
    scene.triangles = {{0, 1, 2}};
    scene.triangle_object = {0};
    scene.objects.resize(1);
    scene.materials.resize(1);
    scene.textures.push_back(ramp(WrapMode::clamp));
    Material& material = scene.materials[0];
    material.reflectance = {0.25f, 0.5f, 1.0f};
    material.emission = {10, 10, 10};
    material.alpha = 0.75f;
    return scene;
}

TEST(SurfaceSample, FactorsWithoutTexture) {
    const Scene scene = textured_scene();
    EXPECT_EQ(surface_reflectance(scene, 0, 0.3f, 0.3f), Rgb(0.25f, 0.5f, 1.0f));
    EXPECT_EQ(surface_emission(scene, 0, 0.3f, 0.3f), Rgb(10, 10, 10));
    EXPECT_EQ(surface_alpha(scene, 0, 0.3f, 0.3f), 1.0f);
    EXPECT_EQ(mean_reflectance(scene, 0, {}), Rgb(0.25f, 0.5f, 1.0f));
    EXPECT_EQ(mean_emission(scene, 0, {}), Rgb(10, 10, 10));
}

TEST(SurfaceSample, TextureTimesFactorThroughTheTransform) {
    Scene scene = textured_scene();
    scene.materials[0].base_texture = scene.materials[0].emissive_texture = 0;
    scene.materials[0].base_transform = {0, 1, 0, 1, 0, 0};  // swaps u and v
    const Rgb got = surface_reflectance(scene, 0, 0.25f, 0.625f);
    EXPECT_FLOAT_EQ(got.x, 0.25f * 2);  // u' = 0.625: column 2
    EXPECT_FLOAT_EQ(got.y, 0.0f);       // v' = 0.25: row 0
    EXPECT_FLOAT_EQ(surface_emission(scene, 0, 0.625f, 0.25f).x, 20.0f);
    EXPECT_FLOAT_EQ(mean_emission(scene, 0, {.b1 = 0.5f, .b2 = 0.5f, .side_s = {1, 0}, .side_t = {0, 1}}).x, 15.0f);
    scene.materials[0].base_uv_set = 1;
    EXPECT_FLOAT_EQ(surface_reflectance(scene, 0, 0.25f, 0.625f).x, 0.0f);
}

TEST(SurfaceSample, AlphaModes) {
    Scene scene = textured_scene();
    Material& material = scene.materials[0];
    material.base_texture = 0;
    material.alpha_mode = AlphaMode::blend;
    EXPECT_FLOAT_EQ(surface_alpha(scene, 0, 0.125f, 0.25f), 0.75f);
    EXPECT_FLOAT_EQ(surface_alpha(scene, 0, 0.875f, 0.05f), 0.0f);
    material.alpha_mode = AlphaMode::mask;
    EXPECT_EQ(surface_alpha(scene, 0, 0.125f, 0.25f), 1.0f);
    EXPECT_EQ(surface_alpha(scene, 0, 0.875f, 0.05f), 0.0f);
    material.alpha_cutoff = 0.8f;
    EXPECT_EQ(surface_alpha(scene, 0, 0.125f, 0.25f), 0.0f);
    material.base_texture = none;
    material.alpha_cutoff = 0.7f;
    EXPECT_EQ(surface_alpha(scene, 0, 0.125f, 0.25f), 1.0f);
}

}  // namespace
}  // namespace luxel
