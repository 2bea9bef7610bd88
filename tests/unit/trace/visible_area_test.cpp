/// What lies inside solids or behind walls does not count as area; everything that light can reach does.
#include "baker/trace/visible_area.h"

#include <gtest/gtest.h>

#include "baker/core/parallel.h"
#include "baker/patches/patch_sampler.h"
#include "tests/support/scenes.h"

namespace luxel {
namespace {

using test::add_quad;
using test::box;
using test::MadeMesh;
using test::moved;
using test::quad;
using test::SceneMaker;

/// A table top of solids: 4 x 4 m, top at y = 0.
MadeMesh slab() { return moved(box(4, 1, 4), {-2, -1, -2}); }

struct Areas {
    double whole = 0, visible = 0;
};

/// Sums over the fragments of an object of which `inside` says true for the place of the texel's middle.
template <class Where>
Areas areas(const test::Prepared& made, const std::string& path, const Where& where) {
    Areas sum;
    for (const PageTexels& page : made.texels.pages)
        for (const Fragment& fragment : page.fragments) {
            const Object& object = made.scene.objects[made.scene.triangle_object[fragment.triangle]];
            if (made.scene.materials[object.material].name != path) continue;
            const Vec2f b = fragment_polygon(made.scene, made.atlas, fragment).centroid();
            if (!where(to_double(surface_position(made.scene, fragment.triangle, b)) + made.scene.origin)) continue;
            sum.whole += static_cast<double>(fragment.area_m2);
            sum.visible += static_cast<double>(fragment.visible_m2());
        }
    return sum;
}

Areas areas(const test::Prepared& made, const std::string& path) {
    return areas(made, path, [](const Vec3d&) { return true; });
}

void expect_all_visible(const test::Prepared& made) {
    for (const PageTexels& page : made.texels.pages)
        for (const Texel& texel : page.texels) ASSERT_EQ(texel.visible_m2, texel.area_m2);
    for (const Fragment& fragment : made.patches.fragments) ASSERT_EQ(fragment.visible, all_visible);
}

TEST(VisibleArea, BoxHalfSunkIntoASolid) {
    // 1 x 1 x 1 m, turned so that no side runs along texels; half of it below y = 0.
    MadeMesh cube = moved(box(1, 1, 1), {-0.5f, -0.5f, -0.5f});
    for (Vec3f& p : cube.positions) p = {0.8f * p.x + 0.6f * p.z, p.y, -0.6f * p.x + 0.8f * p.z};
    const auto made = test::prepare(SceneMaker().add("floor", slab()).add("box", cube).build(), {.texels_per_metre = 16});
    const auto in_box = [](const Vec3d& p, double margin) {
        return std::abs(0.8 * p.x - 0.6 * p.z) < 0.5 + margin && std::abs(0.6 * p.x + 0.8 * p.z) < 0.5 + margin;
    };
    constexpr double texel = 1.0 / 16;
    const auto on_top = [](const Vec3d& p) { return p.y > -1e-3; };
    const Areas under = areas(*made, "floor", [&](const Vec3d& p) { return on_top(p) && in_box(p, -texel); });
    const Areas beside = areas(*made, "floor", [&](const Vec3d& p) { return !on_top(p) || !in_box(p, texel); });
    EXPECT_EQ(under.visible, 0);
    EXPECT_EQ(beside.visible, beside.whole);
    const Areas buried = areas(*made, "box", [](const Vec3d& p) { return p.y < -texel; });
    const Areas free = areas(*made, "box", [](const Vec3d& p) { return p.y > texel; });
    EXPECT_EQ(buried.visible, 0);
    EXPECT_EQ(free.visible, free.whole);
    // The cells' middles decide: exact up to their number along the lines where the two cross.
    EXPECT_NEAR(areas(*made, "floor").visible, 4 * 4 * 2 + 4 * 4 - 1, 0.01);
    EXPECT_NEAR(areas(*made, "box").visible, 1 + 4 * 0.5, 0.01);
    EXPECT_NEAR(areas(*made, "box").whole, 6, 6e-4) << "the raster's areas stay what they were";
}

TEST(VisibleArea, PatchesCountOnlyWhatIsVisible) {
    test::MadeMaterial glow;
    glow.nits = {1, 2, 3};
    const auto made = test::prepare(SceneMaker()
                                        .add("floor", slab(), glow)
                                        .add("ball", test::icosphere(3, 0.8f), glow)
                                        .build(),
                                    {.texels_per_metre = 16});
    double patches = 0, texels = 0, power = 0, texel_power = 0;
    for (PatchNumber p = 0; p < made->patches.count(); ++p) {
        const Patch& patch = made->patches.patches[p];
        ASSERT_GT(patch.area_m2, 0);
        patches += static_cast<double>(patch.area_m2);
        power += static_cast<double>(patch.area_m2) * static_cast<double>(patch.emission.y);
        // No point of the sampler lies in the ball or the slab by more than half a texel: the cells of cut texels are longer
        // than a quarter of one.
        const PatchSampler sampler(made->scene, made->atlas, made->patches, p);
        for (int k = 0; k < 64; ++k) {
            const SurfacePoint at =
                sampler.point((static_cast<float>(k % 8) + 0.5f) / 8, (static_cast<float>(k / 8) + 0.5f) / 8);
            const Vec3d place = to_double(at.position) + made->scene.origin;
            if (made->path_of(p) == "floor") ASSERT_GT(place.length(), 0.8 - 1.0 / 32);
            else ASSERT_GT(place.y, -1.0 / 32);
        }
    }
    for (const PageTexels& page : made->texels.pages)
        for (const Texel& texel : page.texels) {
            texels += static_cast<double>(texel.visible_m2);
            texel_power += static_cast<double>(texel.visible_m2) * static_cast<double>(texel.emission.y);
        }
    EXPECT_NEAR(patches, texels, 1e-6 * texels);
    EXPECT_NEAR(power, texel_power, 1e-5 * power);
    EXPECT_NEAR(power / patches, 2 * 3.14159265358979, 1e-4);
}

TEST(VisibleArea, WhatReachesThroughAWall) {
    // A room's walls have no thickness: behind them is nothing at all.
    const auto made = test::prepare(SceneMaker()
                                        .add("walls", test::room({0, 0, 0}, {4, 3, 4}))
                                        .add("box", moved(box(1, 1, 1), {1.03f, -0.3f, 1.01f}))
                                        .build(),
                                    {.texels_per_metre = 16});
    // The bottom sees nothing at all: it is dark, and no seam.
    const Areas below = areas(*made, "box", [](const Vec3d& p) { return p.y < -1.0 / 16 && p.y > -0.299; });
    const Areas above = areas(*made, "box", [](const Vec3d& p) { return p.y > 1.0 / 16; });
    EXPECT_EQ(below.visible, 0);
    EXPECT_EQ(above.visible, above.whole);
    EXPECT_NEAR(areas(*made, "walls").visible, 2 * (12 + 12 + 16) - 1, 0.03);
}

TEST(VisibleArea, ClosedRoomsStayWhole) {
    expect_all_visible(*test::prepare(SceneMaker().add("cube", test::room({-1, -1, -1}, {1, 1, 1})).build(),
                                      {.texels_per_metre = 16}));
    expect_all_visible(*test::prepare(SceneMaker().add("ball", test::turned(test::icosphere(3, 1))).build()));
    const auto rooms = test::two_rooms();
    expect_all_visible(*test::prepare(SceneMaker().add("a", rooms[0]).add("b", rooms[1]).build()));
}

TEST(VisibleArea, AbuttingBoxes) {
    // Faces that touch are hidden, all others are not.
    const auto made = test::prepare(SceneMaker().add("a", box(1, 1, 1)).add("b", moved(box(1, 1, 1), {1, 0, 0})).build());
    for (const char* path : {"a", "b"}) {
        const auto touching = [](const Vec3d& p) { return std::abs(p.x - 1) < 1e-3; };
        const Areas inner = areas(*made, path, touching);
        const Areas outer = areas(*made, path, [&](const Vec3d& p) { return !touching(p); });
        EXPECT_NEAR(inner.whole, 1, 1e-4);
        EXPECT_EQ(inner.visible, 0) << path;
        EXPECT_EQ(outer.visible, outer.whole) << path;
    }
}

TEST(VisibleArea, ThinGapsStayOpen) {
    expect_all_visible(
        *test::prepare(SceneMaker().add("a", box(1, 1, 1)).add("b", moved(box(1, 1, 1), {1.001f, 0, 0})).build()));
}

TEST(VisibleArea, TwoSidedSheetsAndWhatTheyCover) {
    test::MadeMaterial two_sided;
    two_sided.double_sided = true;
    // A sheet through the floor of a room, and a closed tent of sheets: someone may live in it.
    const auto made = test::prepare(SceneMaker()
                                        .add("walls", test::room({0, 0, 0}, {4, 3, 4}))
                                        .add("sheet", quad({1, 0, 1}, {0, 1, 0}, {0, 0, 1}), two_sided)
                                        .add("tent", moved(box(1, 1, 1), {2, -0.5f, 2}), two_sided)
                                        .build());
    EXPECT_EQ(areas(*made, "walls").visible, areas(*made, "walls").whole);
    EXPECT_EQ(areas(*made, "sheet").visible, areas(*made, "sheet").whole);
    const Areas above = areas(*made, "tent", [](const Vec3d& p) { return p.y > 0.2; });
    EXPECT_EQ(above.visible, above.whole);
}

TEST(VisibleArea, TwoSidedSheetSunkIntoASolid) {
    test::MadeMaterial two_sided;
    two_sided.double_sided = true;
    const auto made = test::prepare(
        SceneMaker().add("floor", slab()).add("sheet", quad({0, -0.5f, 0}, {0, 1, 0}, {0, 0, 1}), two_sided).build());
    EXPECT_NEAR(areas(*made, "sheet").visible, 0.5, 0.02);
    EXPECT_EQ(areas(*made, "floor").visible, areas(*made, "floor").whole);
    for (const Patch& patch : made->patches.patches) EXPECT_GT(patch.area_m2, 0);
}

TEST(VisibleArea, OpenScenesWithPlanesSeenFromBehind) {
    // A roof over a ground, its front up; a board that stands on the ground, with another thing to be seen.
    const auto roof = test::prepare(SceneMaker()
                                        .add("ground", quad({0, 0, 0}, {0, 0, 6}, {6, 0, 0}))
                                        .add("roof", quad({1, 2, 1}, {0, 0, 4}, {4, 0, 0}))
                                        .build());
    expect_all_visible(*roof);
    const auto board = test::prepare(SceneMaker()
                                         .add("ground", quad({0, 0, 0}, {0, 0, 6}, {6, 0, 0}))
                                         .add("board", quad({3, 0, 1}, {0, 0, 4}, {0, 2, 0}))
                                         .add("hut", moved(box(2, 3, 6), {-4, 0, 0}))
                                         .add("house", moved(box(2, 3, 6), {8, 0, 0}))
                                         .build());
    EXPECT_EQ(areas(*board, "ground").visible, areas(*board, "ground").whole);
    EXPECT_EQ(areas(*board, "board").visible, areas(*board, "board").whole);
}

TEST(VisibleArea, CoplanarDecal) {
    const auto made = test::prepare(SceneMaker()
                                        .add("walls", test::room({0, 0, 0}, {4, 3, 4}))
                                        .add("decal", quad({1, 0, 1}, {0, 0, 1}, {1, 0, 0}))
                                        .build());
    expect_all_visible(*made);
}

/// A post inside of a box, and boxes that cut each other: the fronts inside are hidden too, so they do not make the floor there visible.
TEST(VisibleArea, ThingsInsideSolidsAreHiddenAndHide) {
    const auto made = test::prepare(SceneMaker()
                                        .add("walls", test::room({0, 0, 0}, {4, 3, 4}))
                                        .add("box", moved(box(1, 1.5f, 1), {1, -0.5f, 1}))
                                        .add("post", moved(box(0.1f, 2.5f, 0.1f), {1.2f, -0.5f, 1.22f}))
                                        .add("second", moved(box(1, 1, 1), {1.63f, -0.3f, 1.41f}))
                                        .build(),
                                    {.texels_per_metre = 16});
    const auto well_inside = [](const Vec3d& p, double low, double high) {
        return p.x > 1.07 && p.x < 1.93 && p.z > 1.07 && p.z < 1.93 && p.y > low && p.y < high;
    };
    const Areas post = areas(*made, "post", [&](const Vec3d& p) { return well_inside(p, 0.05, 0.9); });
    EXPECT_GT(post.whole, 0.3);
    EXPECT_LT(post.visible, 0.1 * post.whole) << "what is left sees the floor most of all";
    const Areas floor = areas(*made, "walls", [&](const Vec3d& p) { return well_inside(p, -0.01, 0.01); });
    EXPECT_GT(floor.whole, 0.6);
    EXPECT_LT(floor.visible, 0.05 * floor.whole) << "three quarters of it when any front counts";
    // 1 + 1 m2 of the floor less what both cover.
    const double covered = 2 - (2 - 1.63) * (2 - 1.41);
    EXPECT_NEAR(areas(*made, "walls").visible, 2 * (12 + 12 + 16) - covered, 0.04);
    const Areas free = areas(*made, "post", [](const Vec3d& p) { return p.y > 1.1; });
    EXPECT_EQ(free.visible, free.whole);
}

/// More than half of the view is backs, and yet there is light: a ceiling seen from behind, low over the floor of a room.
TEST(VisibleArea, BacksOverheadHideNothingThatLightReaches) {
    const auto made = test::prepare(SceneMaker()
                                        .add("walls", test::room({0, 0, 0}, {4, 3, 4}))
                                        .add("canopy", quad({1, 0.6f, 1}, {0, 0, 2}, {2, 0, 0}))
                                        .build());
    expect_all_visible(*made);
}

TEST(VisibleArea, WhatShinesKeepsTheInside) {
    for (const bool lit : {false, true}) {
        test::MadeMaterial bulb;
        if (lit) bulb.nits = {1, 1, 1};
        const auto made = test::prepare(SceneMaker()
                                            .add("shade", box(1, 1, 1))
                                            .add("bulb", moved(test::icosphere(1, 0.1f), {0.5f, 0.5f, 0.5f}), bulb)
                                            .add("base", moved(box(0.3f, 0.1f, 0.3f), {0.35f, 0.01f, 0.35f}))
                                            .build(),
                                        {.texels_per_metre = 16});
        const Areas base = areas(*made, "base", [](const Vec3d& p) { return p.y > 0.109; });
        EXPECT_NEAR(base.visible, lit ? base.whole : 0, 1e-6);
    }
}

TEST(VisibleArea, ALampInsideKeepsTheInside) {
    // A house that was modelled from outside only; the lamp in it is on or off.
    const auto make = [](bool lit) {
        SceneMaker maker;
        maker.add("house", moved(box(4, 3, 4), {0, -0.5f, 0})).add("ground", quad({-2, 0, -2}, {0, 0, 8}, {8, 0, 0}));
        LampRecord lamp;
        lamp.kind = LampKind::point;
        lamp.world.setTranslation(Vec3d(2, 2, 2));
        lamp.intensity = lit ? std::array{1.0, 1.0, 1.0} : std::array{0.0, 0.0, 0.0};
        maker.add_lamp(lamp);
        return test::prepare(maker.build());
    };
    const auto inside = [](const Vec3d& p) { return p.x > 0.2 && p.x < 3.8 && p.z > 0.2 && p.z < 3.8; };
    const auto dark = make(false), lit = make(true);
    EXPECT_EQ(areas(*dark, "ground", inside).visible, 0);
    EXPECT_EQ(areas(*lit, "ground", inside).visible, areas(*lit, "ground", inside).whole);
}

TEST(VisibleArea, DoesNotDependOnThreads) {
    std::vector<std::vector<VisibleCells>> found;
    for (const unsigned threads : {1u, 4u}) {
        const ThreadLimit limit(threads);
        const auto made = test::prepare(
            SceneMaker().add("floor", slab()).add("ball", test::icosphere(3, 0.8f)).build(), {.texels_per_metre = 16});
        auto& cells = found.emplace_back();
        for (const PageTexels& page : made->texels.pages)
            for (const Fragment& fragment : page.fragments) cells.push_back(fragment.visible);
    }
    EXPECT_EQ(found[0], found[1]);
}

}  // namespace
}  // namespace luxel
