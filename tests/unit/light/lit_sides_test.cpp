/// Which two-sided surfaces lie with their front in the dark: verdicts on closed boxes and rooms.
#include "baker/light/lit_sides.h"

#include <gtest/gtest.h>

#include <array>
#include <span>

#include "baker/patches/fragment_polygon.h"
#include "tests/support/scenes.h"

namespace luxel {
namespace {

using test::box;
using test::moved;
using test::room;
using test::SceneMaker;
using test::turned;

test::MadeMaterial two_sided(double nits = 0) {
    return {.nits = {nits, nits, nits}, .double_sided = true};
}

LampRecord lamp_at(const Vec3f& place) {
    LampRecord lamp;
    lamp.kind = LampKind::point;
    lamp.intensity = {100, 100, 100};
    lamp.world.setTranslation(Imath::V3d(place.x, place.y, place.z));
    return lamp;
}

/// A box of 1 m inside a room of 4 m; both as given.
DarkFronts verdict(const test::MadeMesh& box, const test::MadeMaterial& of_box, const Vec3f& lamp, const test::MadeMaterial& of_room = {}) {
    const auto made = test::prepare(SceneMaker().add("room", room({0, 0, 0}, {4, 4, 4}), of_room).add("box", moved(box, {1, 1, 1}), of_box).add_lamp(lamp_at(lamp)).build());
    DarkFronts found = find_dark_fronts(made->scene, made->atlas, *made->tracer);
    for (std::size_t c = 0; c < found.charts.size(); ++c)
        if (found.charts[c]) {
            EXPECT_EQ(made->scene.materials[made->scene.objects[made->atlas.charts[c].object].material].name, "box");
        }
    return found;
}

TEST(LitSides, AnInsideOutBoxInALitRoomHasDarkFronts) {
    const DarkFronts found = verdict(turned(box(1, 1, 1)), two_sided(), {3, 3, 3});
    EXPECT_NEAR(found.area_m2, 6, 1e-4);  // those that the lamp does not see are lit by the walls
    EXPECT_GE(found.chart_count, 1u);
}

TEST(LitSides, FrontsThatSeeLightStay) {
    EXPECT_EQ(verdict(box(1, 1, 1), two_sided(), {3, 3, 3}).chart_count, 0u);
    // The lamp is inside: the backs are dark.
    EXPECT_EQ(verdict(turned(box(1, 1, 1)), two_sided(), {1.5f, 1.5f, 1.5f}).chart_count, 0u);
}

TEST(LitSides, OneSidedSurfacesHaveNoOtherSide) {
    EXPECT_EQ(verdict(turned(box(1, 1, 1)), {}, {3, 3, 3}).chart_count, 0u);
}

/// Lamps seen by none, both sides dark.
TEST(LitSides, BothSidesInTheDarkStay) {
    EXPECT_EQ(verdict(turned(box(1, 1, 1)), two_sided(), {9, 9, 9}).chart_count, 0u);
}

TEST(LitSides, SmallSurfacesThatShineAreFound) {
    test::MadeMesh panel = test::quad({0, 3.9f, 0}, {0.02f, 0, 0}, {0, 0, 0.02f});  // faces down
    const auto made = test::prepare(SceneMaker()
                                        .add("room", room({0, 0, 0}, {4, 4, 4}))
                                        .add("box", moved(turned(box(1, 1, 1)), {1, 1, 1}), two_sided())
                                        .add("panel", moved(panel, {2, 0, 2}), two_sided(1000))
                                        .build());
    EXPECT_NEAR(find_dark_fronts(made->scene, made->atlas, *made->tracer).area_m2, 6, 1e-4);
}

/// The back is a hundred times as bright as the front, which is as bright as the room.
TEST(LitSides, FrontsAsBrightAsTheRoomStay) {
    const auto made = test::prepare(SceneMaker()
                                        .add("room", room({0, 0, 0}, {4, 4, 4}))
                                        .add("shade", test::quad({1.9f, 1.9f, 2}, {0.2f, 0, 0}, {0, 0.2f, 0}), two_sided())
                                        .add_lamp(lamp_at({2, 2, 1.9f}))
                                        .build());
    EXPECT_EQ(find_dark_fronts(made->scene, made->atlas, *made->tracer).chart_count, 0u);
}

/// The outside is in full light, the inside has a hundredth of it, through a window.
TEST(LitSides, RoomsBehindAWindowStay) {
    test::MadeMesh walls;
    test::add_quad(walls, {0, 0, 0}, {0, 0, 4}, {4, 0, 0});
    test::add_quad(walls, {0, 3, 0}, {4, 0, 0}, {0, 0, 4});
    test::add_quad(walls, {0, 0, 0}, {4, 0, 0}, {0, 3, 0});
    test::add_quad(walls, {0, 0, 4}, {0, 3, 0}, {4, 0, 0});
    test::add_quad(walls, {0, 0, 0}, {0, 3, 0}, {0, 0, 4});
    test::add_quad(walls, {4, 0, 0}, {0, 0, 3.9f}, {0, 3, 0});  // beside a window of 10 cm
    Scene scene = SceneMaker().add("walls", walls, two_sided()).build();
    scene.sky = {.width = 1, .height = 1, .nits = {Rgb(1000, 1000, 1000)}};
    const auto made = test::prepare(std::move(scene));
    EXPECT_EQ(find_dark_fronts(made->scene, made->atlas, *made->tracer).chart_count, 0u);
}

TEST(LitSides, WithoutLightNothingIsDark) {
    const auto made = test::prepare(SceneMaker().add("box", turned(box(1, 1, 1)), two_sided()).build());
    const DarkFronts found = find_dark_fronts(made->scene, made->atlas, *made->tracer, true);
    EXPECT_EQ(found.chart_count, 0u);
    EXPECT_EQ(found.unlit, std::vector<bool>(made->atlas.charts.size(), true));
}

/// What is turned has its front where rays come from, and its normals there.
TEST(LitSides, TurnedTrianglesSwapTheirSides) {
    auto made = test::prepare(SceneMaker().add("sheet", test::quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0}), two_sided()).build());
    Scene& scene = made->scene;
    const Vec3f normal = scene.geometric_normal(0), shading = shading_normal(scene, 0, Vec2f(0.2f, 0.2f));
    const TraceRay ray{(scene.corner(0, 0) + scene.corner(0, 1) + scene.corner(0, 2)) / 3 + normal, -normal};
    std::array<TraceHit, 1> hits;
    made->tracer->first_hits(std::span(&ray, 1), hits);
    EXPECT_TRUE(made->tracer->first_hit(ray).front);
    EXPECT_TRUE(hits[0].front);
    scene.turned.assign(scene.triangle_count(), true);
    EXPECT_EQ(scene.geometric_normal(0), -normal);
    EXPECT_EQ(shading_normal(scene, 0, Vec2f(0.2f, 0.2f)), -shading);
    made->tracer->first_hits(std::span(&ray, 1), hits);
    EXPECT_FALSE(made->tracer->first_hit(ray).front);
    EXPECT_FALSE(hits[0].front);
}

}  // namespace
}  // namespace luxel
