/// Colours of vertices: what of them gets into the scene, how they multiply base colour and alpha, and which keys hold them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "baker/light/pane_colour.h"
#include "baker/scene/see_through.h"
#include "baker/scene/texture_sample.h"
#include "tests/support/see_through.h"

namespace luxel {
namespace {

using test::SceneMaker;

/// A unit square of two triangles, (0, 1, 2) and (0, 2, 3), with these colours at its four corners.
SceneMaker square(const std::vector<Rgba>& colors) {
    SceneMaker maker;
    maker.add("square", test::quad({0, 0, 0}, {0, 0, 1}, {1, 0, 0}), {.reflectance = {0.5, 1, 0.25}});
    maker.record().meshes[0].primitives[0].colors = colors;
    return maker;
}
const std::vector<Rgba> four{{1, 1, 1, 1}, {0.5f, 0, 1, 0.25f}, {0, 1, 0, 0.5f}, {1, 1, 1, 1}};

TEST(VertexColor, MultipliesReflectanceLinearlyBetweenVertices) {
    const Scene scene = square(four).build();
    ASSERT_EQ(scene.colors.size(), 6u) << "flat shading: a vertex per corner";
    EXPECT_EQ(surface_reflectance(scene, 0, 0, 0), Rgb(0.5f, 1, 0.25f));
    EXPECT_EQ(surface_reflectance(scene, 0, 1, 0), Rgb(0.25f, 0, 0.25f));
    EXPECT_EQ(surface_reflectance(scene, 0, 0, 1), Rgb(0, 1, 0));
    const Rgb middle = surface_reflectance(scene, 0, 0.25f, 0.5f);
    EXPECT_FLOAT_EQ(middle.x, 0.5f * (0.25f + 0.25f * 0.5f));
    EXPECT_FLOAT_EQ(middle.y, 0.25f + 0.5f);
    EXPECT_FLOAT_EQ(middle.z, 0.25f * (0.25f + 0.25f));
    EXPECT_EQ(mean_reflectance(scene, 0, {.b1 = 0.25f, .b2 = 0.5f, .side_s = {0.25f, 0}, .side_t = {0, 0.25f}}), middle);
    EXPECT_EQ(surface_emission(scene, 0, 1, 0), Rgb(0, 0, 0));
    EXPECT_EQ(surface_alpha(scene, 0, 1, 0), 1) << "opaque";
}

TEST(VertexColor, VariesTogetherWithTheTexture) {
    // White where the vertices are black and the other way round: the mean of the product is not the product of means.
    SceneMaker maker = square({{1, 1, 1, 1}, {0, 0, 0, 1}, {0, 0, 0, 1}, {1, 1, 1, 1}});
    test::last_material(maker).base_color = {1, 1, 1, 1};
    test::last_material(maker).base_color_texture = test::add_picture(maker, 2, 1, [](int x, int) {
        const std::uint8_t value = x ? 255 : 0;
        return std::array<std::uint8_t, 4>{value, value, value, 255};
    });
    maker.record().meshes[0].primitives[0].uv[0] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    const Scene scene = test::build_with_pictures(maker);
    // All along corner 0 to corner 1, at the height of corner 0; 2 samples: colour 3/4 on black, 1/4 on white.
    const Rgb mean = mean_reflectance(scene, 0, {.b1 = 0.5f, .b2 = 0, .side_s = {1, 0}, .side_t = {0, 0}});
    EXPECT_FLOAT_EQ(mean.x, 0.125f);
    // Beyond the triangle colours stay what they can be.
    EXPECT_EQ(surface_reflectance(scene, 0, 1.5f, 0), Rgb(0, 0, 0));
    EXPECT_LE(surface_reflectance(scene, 0, -0.5f, 0).x, 1);
}

TEST(VertexColor, WhiteIsNothing) {
    const Scene white = square(std::vector<Rgba>(4, {1, 1, 1, 1})).build(), none_at_all = square({}).build();
    EXPECT_TRUE(white.colors.empty());
    EXPECT_FALSE(white.objects[0].is_painted());
    EXPECT_EQ(white.geometry_key, none_at_all.geometry_key);
    EXPECT_EQ(white.light_key, none_at_all.light_key);
    EXPECT_EQ(white.resident_bytes(), none_at_all.resident_bytes());
}

TEST(VertexColor, OnlyPaintedObjectsPay) {
    SceneMaker maker = square({});
    maker.add("painted", test::quad({5, 0, 0}, {0, 0, 1}, {1, 0, 0}));
    maker.record().meshes[1].primitives[0].colors = four;
    maker.add("plain", test::quad({9, 0, 0}, {0, 0, 1}, {1, 0, 0}), {.reflectance = {1, 1, 1}});
    const Scene scene = maker.build();
    EXPECT_EQ(scene.colors.size(), 6u);
    EXPECT_EQ(surface_reflectance(scene, 0, 1, 0), Rgb(0.5f, 1, 0.25f));
    EXPECT_EQ(surface_reflectance(scene, 2, 1, 0), Rgb(0.25f, 0, 0.5f));
    EXPECT_EQ(surface_reflectance(scene, 4, 1, 0), Rgb(1, 1, 1));
    EXPECT_TRUE(has_varied_base(scene, 2));
    EXPECT_FALSE(has_varied_base(scene, 4));
}

TEST(VertexColor, OutOfRangeIsClampedOrRefused) {
    SceneMaker maker = square({{2, -1, std::numeric_limits<float>::quiet_NaN(), 1}, {1, 1, 1 + 1e-7f, 1}, {1, 1, 1, 1}, {0.5f, 1, 1, 1}});
    std::vector<Warning> warnings;
    const Scene scene = build_scene(maker.record(), {}, {}, warnings);
    EXPECT_EQ(scene.colors[0], (Rgba{1, 0, 0, 1}));
    EXPECT_EQ(scene.colors[1], (Rgba{1, 1, 1, 1}));
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_EQ(warnings[0].code, "vertex-colours-clamped");
    EXPECT_THAT(warnings[0].text, testing::HasSubstr("COLOR_0: 2 vertices"));  // one corner, in two triangles
    EXPECT_THROW(build_scene(maker.record(), {}, {.bad_values = BadValues::refuse}, warnings), Error);
}

TEST(VertexColor, AlphaCovers) {
    SceneMaker maker = square(four);
    test::last_material(maker).alpha_mode = AlphaMode::blend;
    test::last_material(maker).base_color = {1, 1, 1, 0.5};
    const Scene blend = maker.build();
    EXPECT_FLOAT_EQ(surface_alpha(blend, 0, 1, 0), 0.125f);
    EXPECT_FLOAT_EQ(surface_passage(blend, 0, 1, 0).opacity, 0.125f);
    EXPECT_EQ(surface_passage(blend, 0, 1, 0).tint, Rgb(1, 1, 1));
    test::last_material(maker).alpha_mode = AlphaMode::mask;
    test::last_material(maker).alpha_cutoff = 0.25;
    const Scene mask = maker.build();
    EXPECT_EQ(surface_alpha(mask, 0, 0, 0), 1);
    EXPECT_EQ(surface_alpha(mask, 0, 1, 0), 0);
    EXPECT_TRUE(surface_passage(mask, 0, 1, 0).is_hole());
}

TEST(VertexColor, AMaterialIsOpaqueOnlyWhereAllItsVerticesAre) {
    for (const float alpha : {1.0f, 0.99f}) {
        SceneMaker maker = square({{0, 1, 1, 1}, {0, 1, 1, 1}, {0, 1, 1, 1}, {0, 1, 1, alpha}});
        test::last_material(maker).alpha_mode = AlphaMode::blend;
        EXPECT_EQ(maker.build().materials[0].is_see_through(), alpha < 1);
    }
}

TEST(VertexColor, PanesTakeIt) {
    SceneMaker maker = square(std::vector<Rgba>(4, {1, 0.5f, 0, 1}));
    test::glass(maker, {0.5, 0.5, 0.5});
    const Scene scene = maker.build();
    EXPECT_EQ(surface_passage(scene, 0, 0.25f, 0.25f).passes(), Rgb(0.5f, 0.25f, 0));
    EXPECT_TRUE(has_tinting_panes(scene));
    maker.record().meshes[0].primitives[0].colors.clear();
    EXPECT_FALSE(has_tinting_panes(maker.build()));
}

/// Rays depend on alpha, and on colours only where these tint what passes; light on all of it.
TEST(VertexColor, Keys) {
    const std::vector<Rgba> other_color{{1, 1, 1, 1}, {0.5f, 0.5f, 1, 0.25f}, {0, 1, 0, 0.5f}, {1, 1, 1, 1}};
    const std::vector<Rgba> other_alpha{{1, 1, 1, 1}, {0.5f, 0, 1, 0.5f}, {0, 1, 0, 0.5f}, {1, 1, 1, 1}};
    const auto keys = [](const std::vector<Rgba>& colors, AlphaMode mode, double transmission = 0) {
        SceneMaker maker = square(colors);
        test::last_material(maker).alpha_mode = mode;
        test::last_material(maker).transmission = transmission;
        const Scene scene = maker.build();
        return std::pair(scene.geometry_key, scene.light_key);
    };
    for (const AlphaMode mode : {AlphaMode::opaque, AlphaMode::mask, AlphaMode::blend}) {
        const bool is_opaque = mode == AlphaMode::opaque;
        const auto known = keys(four, mode), recolored = keys(other_color, mode), thinner = keys(other_alpha, mode);
        EXPECT_EQ(known.first, recolored.first);
        EXPECT_NE(known.second, recolored.second);
        EXPECT_EQ(known.first == thinner.first, is_opaque);
        EXPECT_NE(known.second, thinner.second);
        EXPECT_EQ(known.first == keys({}, mode).first, is_opaque);
    }
    EXPECT_NE(keys(four, AlphaMode::opaque, 0.5).first, keys(other_color, AlphaMode::opaque, 0.5).first) << "it tints";
}

}  // namespace
}  // namespace luxel
