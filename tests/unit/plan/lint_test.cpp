/// What is found in scenes with one fault each, and not in those without.
#include "baker/plan/lint.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/scenes.h"

namespace luxel {
namespace {

using test::quad;
using test::room;
using test::SceneMaker;

LampRecord lamp_at(const Vec3f& place, double candela = 100) {
    LampRecord lamp;
    lamp.kind = LampKind::point;
    lamp.node_path = "lamp";
    lamp.intensity = {candela, candela, candela};
    lamp.world.setTranslation(Imath::V3d(place.x, place.y, place.z));
    return lamp;
}

/// What lint needs of a bake's geometry.
BakedGeometry geometry_of(Scene scene) {
    BakedGeometry g;
    auto made = test::prepare(std::move(scene));
    g.scene = std::move(made->scene), g.atlas = std::move(made->atlas), g.texels = std::move(made->texels);
    g.patches = std::move(made->patches), g.layout = std::move(made->layout);
    return g;
}

std::vector<SceneFinding> lint(Scene scene) {
    BakedGeometry g = geometry_of(std::move(scene));
    g.tracer = std::make_unique<Tracer>(g.scene);
    std::vector<SceneFinding> all = lint_scene(g), light = lint_light(g);
    all.insert(all.end(), light.begin(), light.end());
    return all;
}

std::vector<std::string> codes(const std::vector<SceneFinding>& findings) {
    std::vector<std::string> all;
    for (const SceneFinding& f : findings) all.push_back(f.code);
    return all;
}

SceneMaker lit_room() {
    SceneMaker maker;
    maker.add("room", room({0, 0, 0}, {4, 3, 4})).add_lamp(lamp_at({2, 2.5f, 2}));
    return maker;
}

TEST(Lint, ASoundRoomHasNoFindings) { EXPECT_EQ(codes(lint(lit_room().build())), std::vector<std::string>()); }

TEST(Lint, WhiteWallsAreNamed) {
    const auto found = lint(lit_room().add("snow", quad({1, 1, 1}, {0, 0, 1}, {1, 0, 0}), {.reflectance = {0.5, 0.95, 0.5}}).build());
    ASSERT_EQ(codes(found), std::vector<std::string>{"bright-surfaces"});
    EXPECT_EQ(found[0].where, std::vector<std::string>{"snow: 95 %"});
}

TEST(Lint, LampsWithoutPowerAreNamed) {
    const auto found = lint(lit_room().add_lamp(lamp_at({1, 1, 1}, 0)).build());
    ASSERT_EQ(codes(found), std::vector<std::string>{"dark-lamps"});
    EXPECT_EQ(found[0].where, std::vector<std::string>{"lamp"});
}

TEST(Lint, FacesInOnePlaceAreNamedIfTheyFaceTheSameWay) {
    const auto sheet = quad({1, 1, 1}, {0, 0, 1}, {1, 0, 0});
    const auto found = lint(lit_room().add("a", sheet).add("b", sheet).build());
    ASSERT_EQ(codes(found), (std::vector<std::string>{"crowding", "coincident-faces"}));  // beside two sheets the room has most texels
    EXPECT_EQ(found[1].count, 2u);
    ASSERT_EQ(found[1].where.size(), 1u);
    EXPECT_NE(found[1].where[0].find(" and "), std::string::npos);
    EXPECT_EQ(codes(lint(lit_room().add("a", sheet).add("b", test::turned(sheet)).build())), std::vector<std::string>{"crowding"});
}

TEST(Lint, ObjectsBelowATexelAndCrowdingOnesAreNamed) {
    const auto found = lint(lit_room().add("crumb", quad({1, 1, 1}, {0, 0, 0.05f}, {0.05f, 0, 0})).build());
    ASSERT_EQ(codes(found), std::vector<std::string>{"below-a-texel"});
    EXPECT_NE(found[0].where[0].find("crumb"), std::string::npos);
    const auto crowded = lint(lit_room().add("table", quad({1, 1, 1}, {0, 0, 1}, {1, 0, 0})).build());
    ASSERT_EQ(crowded.size(), 0u);  // a room among two is no crowd
    const auto field = lint(lit_room().add("table", quad({1, 1, 1}, {0, 0, 1}, {1, 0, 0})).add("chair", quad({2, 1, 1}, {0, 0, 1}, {1, 0, 0})).build());
    ASSERT_EQ(codes(field), std::vector<std::string>{"crowding"});
}

TEST(Lint, CoordinatesTooFarOutAreSaid) {
    SceneMaker far;
    const Vec3d away(1e6, 0, 0);  // steps by 6 cm, half a texel
    far.add("room", room({0, 0, 0}, {4, 3, 4}), {}, away);
    LampRecord lamp = lamp_at({0, 0, 0});
    lamp.world.setTranslation(Imath::V3d(1e6 + 2, 2.5, 2));
    EXPECT_EQ(codes(lint(far.add_lamp(lamp).build())), std::vector<std::string>{"far-from-origin"});
}

TEST(Lint, AGapBetweenWallsIsARoomThatLosesLight) {
    test::MadeMesh gappy;  // the ceiling ends 5 cm before the wall
    test::add_quad(gappy, {0, 0, 0}, {0, 0, 4}, {4, 0, 0});
    test::add_quad(gappy, {0, 3, 0}, {3.95f, 0, 0}, {0, 0, 4});
    test::add_quad(gappy, {0, 0, 0}, {4, 0, 0}, {0, 3, 0});
    test::add_quad(gappy, {0, 0, 4}, {0, 3, 0}, {4, 0, 0});
    test::add_quad(gappy, {0, 0, 0}, {0, 3, 0}, {0, 0, 4});
    test::add_quad(gappy, {4, 0, 0}, {0, 0, 4}, {0, 3, 0});
    const auto found = lint(SceneMaker().add("room", gappy).add_lamp(lamp_at({2, 2, 2})).build());
    ASSERT_EQ(codes(found), std::vector<std::string>{"open-room"});
    EXPECT_NE(found[0].where.at(0).find("room"), std::string::npos);
    // A floor in the open is no room.
    EXPECT_EQ(codes(lint(SceneMaker().add("floor", quad({0, 0, 0}, {0, 0, 4}, {4, 0, 0})).add_lamp(lamp_at({2, 2, 2})).build())), std::vector<std::string>());
}

TEST(Lint, SurfacesThatNoLightReachesAreNamed) {
    const auto found = lint(lit_room().add("closet", room({10, 0, 0}, {11, 1, 1})).build());
    ASSERT_EQ(codes(found), std::vector<std::string>{"unlit-surfaces"});
    ASSERT_EQ(found[0].where.size(), 1u);
    EXPECT_NE(found[0].where[0].find("closet"), std::string::npos);
}

TEST(Lint, WithoutAnyLightAllSurfacesAreNamed) {
    const auto found = lint(SceneMaker().add("room", room({0, 0, 0}, {4, 3, 4})).build());
    ASSERT_EQ(codes(found), std::vector<std::string>{"unlit-surfaces"});
    EXPECT_EQ(found[0].text.substr(0, 8), "100.00 %");
}

TEST(Lint, DarkFrontsAreNamed) {
    const auto found = lint(lit_room().add("crate", test::moved(test::turned(test::box(1, 1, 1)), {1, 1, 1}), {.double_sided = true}).build());
    ASSERT_EQ(codes(found), std::vector<std::string>{"dark-fronts"});
    EXPECT_NE(found[0].where[0].find("crate"), std::string::npos);
}

}  // namespace
}  // namespace luxel
