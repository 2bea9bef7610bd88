/// What passes and what meets, for every kind of material; never more than arrives.
#include "baker/scene/see_through.h"

#include <gtest/gtest.h>

#include "tests/support/see_through.h"

namespace luxel {
namespace {

using test::SceneMaker;

SceneMaker one_quad() {
    SceneMaker maker;
    maker.add("quad", test::quad({0, 0, 0}, {0, 0, 1}, {1, 0, 0}));
    return maker;
}

TEST(SurfacePassage, Opaque) {
    SceneMaker maker = one_quad();
    test::last_material(maker).base_color = {0.5, 0.5, 0.5, 0.25};  // alpha means nothing here
    const Scene scene = maker.build();
    EXPECT_FALSE(scene.materials[0].is_see_through());
    EXPECT_EQ(surface_passage(scene, 0, 0.3f, 0.3f).opacity, 1);
    EXPECT_EQ(surface_passage(scene, 0, 0.3f, 0.3f).passes(), Rgb(0, 0, 0));
}

TEST(SurfacePassage, AlphaAndTransmissionTogether) {
    SceneMaker maker = one_quad();
    test::blend(maker, 0.75, {1, 0.5, 0});
    test::last_material(maker).transmission = 0.4;
    for (const bool colours : {false, true}) {
        const Scene scene = test::build_with_pictures(maker, {.blend_colours = colours});
        const Passage at = surface_passage(scene, 0, 0.3f, 0.3f);
        EXPECT_NEAR(at.opacity, 0.75f * 0.6f, 1e-6f);
        for (int c = 0; c < 3; ++c) {
            const float base = c == 0 ? 1 : c == 1 ? 0.5f : 0, beside = colours ? base : 1;
            EXPECT_NEAR(at.passes()[c], 0.25f * beside + 0.75f * 0.4f * base, 1e-6f);
            EXPECT_LE(at.passes()[c] + at.opacity, 1 + 1e-6f);
        }
        EXPECT_EQ(scene.materials[0].reflectance, Rgb(1, 0.5f, 0)) << "of what is met";
    }
}

TEST(SurfacePassage, TransmissionTexturesAreLinearAndRed) {
    SceneMaker maker = one_quad();
    test::glass(maker, {1, 1, 1}, 0.8);
    test::last_material(maker).transmission_texture =
        test::add_picture(maker, 1, 1, [](int, int) { return std::array<std::uint8_t, 4>{128, 255, 255, 255}; });
    maker.record().meshes[0].primitives[0].uv[0].assign(4, {0, 0});
    EXPECT_NEAR(surface_passage(test::build_with_pictures(maker), 0, 0.3f, 0.3f).opacity, 1 - 0.8f * 128 / 255, 1e-6f);
}

TEST(SurfacePassage, WhatEmitsTransmitsNothing) {
    SceneMaker maker = one_quad();
    test::glass(maker, {1, 1, 1}, 0.75);
    test::last_material(maker).emission = {1, 1, 1};
    std::vector<Warning> warnings;
    const Scene scene = build_scene(maker.record(), {}, {}, warnings);
    EXPECT_FALSE(scene.materials[0].is_see_through());
    EXPECT_EQ(scene.materials[0].reflectance, Rgb(0.25f, 0.25f, 0.25f));
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_EQ(warnings[0].code, "transmission-blocked");
}

TEST(SurfacePassage, AlphaThatCoversEverywhereIsOpaque) {
    for (const AlphaMode mode : {AlphaMode::mask, AlphaMode::blend})
        for (const std::uint8_t alpha : {std::uint8_t{255}, std::uint8_t{254}, std::uint8_t{127}}) {
            SceneMaker maker = one_quad();
            const TextureUse use = test::add_picture(maker, 2, 1, [&](int x, int) {
                return std::array<std::uint8_t, 4>{1, 2, 3, x ? alpha : std::uint8_t{255}};
            });
            test::last_material(maker).alpha_mode = mode;
            test::last_material(maker).base_color_texture = use;
            const bool opaque = alpha == 255 || (mode == AlphaMode::mask && alpha > 127);
            EXPECT_EQ(test::build_with_pictures(maker).materials[0].is_see_through(), !opaque);
        }
}

TEST(SurfacePassage, MeansAreOfWhatIsMet) {
    SceneMaker maker = one_quad();
    // Solid and dark on the left, a hole with a bright colour on the right.
    test::last_material(maker).base_color_texture = test::add_picture(maker, 2, 1, [](int x, int) {
        return x ? std::array<std::uint8_t, 4>{255, 255, 255, 0} : std::array<std::uint8_t, 4>{0, 0, 0, 255};
    });
    test::last_material(maker).alpha_mode = AlphaMode::mask;
    maker.record().meshes[0].primitives[0].uv[0] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    const Scene scene = test::build_with_pictures(maker);
    const std::array<Vec2f, 4> points{{{0.1f, 0}, {0.2f, 0}, {0.3f, 0}, {0.8f, 0}}};
    const SeeThroughMean mean = mean_see_through(scene, 0, points);
    EXPECT_EQ(mean.coverage, 0.75f);
    EXPECT_EQ(mean.opacity, 0.75f);
    EXPECT_EQ(mean.reflectance, Rgb(0, 0, 0));
}

/// All that rays depend on is in the geometry's key, and only that.
TEST(SurfacePassage, GeometryKeyHoldsWhatRaysDependOn) {
    const auto key = [](const std::function<void(MaterialRecord&)>& edit, bool blend_colours = false, std::uint8_t alpha = 9,
                        std::uint8_t red = 9) {
        SceneMaker maker = one_quad();
        maker.record().meshes[0].primitives[0].uv[0].assign(4, {0, 0});
        const TextureUse use = test::add_picture(maker, 2, 1, [&](int x, int) {
            return std::array<std::uint8_t, 4>{x ? red : std::uint8_t{0}, 0, 0, x ? alpha : std::uint8_t{200}};
        });
        MaterialRecord& material = test::last_material(maker);
        material.base_color_texture = material.transmission_texture = use;
        material.alpha_mode = AlphaMode::mask;
        edit(material);
        return test::build_with_pictures(maker, {.blend_colours = blend_colours}).geometry_key;
    };
    const auto mask = [](MaterialRecord&) {};
    const auto blend = [](MaterialRecord& m) { m.alpha_mode = AlphaMode::blend; };
    const auto pane = [](MaterialRecord& m) { m.alpha_mode = AlphaMode::opaque, m.transmission = 0.5; };
    const auto with = [](const auto& kind, const auto& edit) {
        return [=](MaterialRecord& m) { kind(m), edit(m); };
    };
    EXPECT_NE(key(mask), key(mask, false, 10)) << "alpha of the texture";
    EXPECT_EQ(key(mask), key(mask, false, 9, 10)) << "its colour is light's";
    EXPECT_NE(key(mask), key(with(mask, [](MaterialRecord& m) { m.alpha_cutoff = 0.25; })));
    EXPECT_NE(key(mask), key(with(mask, [](MaterialRecord& m) { m.base_color[3] = 0.9; })));
    EXPECT_NE(key(mask), key(blend));
    EXPECT_NE(key(blend), key(blend, true));
    const auto dark = [](MaterialRecord& m) { m.base_color[1] = 0.25; };
    EXPECT_EQ(key(blend), key(with(blend, dark)));
    EXPECT_NE(key(blend, true), key(with(blend, dark), true)) << "it tints";
    EXPECT_NE(key(blend, true), key(blend, true, 9, 10));
    EXPECT_NE(key(pane), key(with(pane, dark)));
    EXPECT_NE(key(pane), key(pane, false, 9, 10)) << "colour and transmission of the texture";
    EXPECT_NE(key(pane), key(with(pane, [](MaterialRecord& m) { m.transmission = 0.25; })));
}

}  // namespace
}  // namespace luxel
