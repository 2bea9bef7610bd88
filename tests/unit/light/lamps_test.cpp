/// Lamps against closed forms, their shadows, and the exact mean of the choice among weak ones.
#include "baker/light/lamps.h"

#include <gtest/gtest.h>

#include <cmath>

#include "baker/core/units.h"
#include "tests/support/scenes.h"

namespace luxel {
namespace {

using test::quad;
using test::SceneMaker;

Lamp point_lamp(const Vec3f& position, float candela) {
    Lamp lamp;
    lamp.kind = LampKind::point;
    lamp.position = position;
    lamp.direction = {0, -1, 0};
    lamp.intensity = {candela, 2 * candela, 3 * candela};
    return lamp;
}

constexpr float pi_f = 3.14159265f;

TEST(Lamps, PointLampFallsWithTheSquareAndTheCosine) {
    for (const float distance : {0.01f, 1.0f, 7.0f, 1e4f})
        for (const float angle : {0.0f, 0.5f, 1.2f, 1.5f}) {
            const Lamp lamp = point_lamp({0, distance, 0}, 100);
            const Rgb e = unshadowed_irradiance(lamp, {0, 0, 0}, {std::sin(angle), std::cos(angle), 0});
            const float expected = 100 * std::cos(angle) / (distance * distance);
            EXPECT_NEAR(e.x, expected, 1e-5f * expected);
            EXPECT_NEAR(e.y, 2 * expected, 2e-5f * expected);
            EXPECT_NEAR(e.z, 3 * expected, 3e-5f * expected);
        }
    EXPECT_EQ(unshadowed_irradiance(point_lamp({0, -1, 0}, 1), {0, 0, 0}, {0, 1, 0}), Rgb(0, 0, 0)) << "from behind";
    EXPECT_EQ(unshadowed_irradiance(point_lamp({0, 0, 0}, 1), {0, 0, 0}, {0, 1, 0}), Rgb(0, 0, 0)) << "at the lamp";
}

TEST(Lamps, SunOnATiltedPlane) {
    Lamp sun = point_lamp({0, 0, 0}, 1e5f);
    sun.kind = LampKind::directional;
    for (int degrees = 0; degrees <= 180; degrees += 15) {
        const float angle = static_cast<float>(degrees) * pi_f / 180;
        const Rgb e = unshadowed_irradiance(sun, {1e3f, 5, -7}, {std::sin(angle), std::cos(angle), 0});
        EXPECT_NEAR(e.x, 1e5f * std::max(0.0f, std::cos(angle)), 0.02f) << degrees;
    }
}

TEST(Lamps, SpotFallsBetweenItsCones) {
    Lamp spot = point_lamp({0, 2, 0}, 8);
    spot.kind = LampKind::spot;
    spot.cos_inner = 0.95f, spot.cos_outer = 0.8f;
    for (const float along : {1.0f, 0.96f, 0.95f, 0.9f, 0.85f, 0.81f, 0.8f, 0.79f, 0.1f, -0.5f}) {
        const float off_axis = std::sqrt(1 - along * along);
        // Two metres away on the sphere around the lamp, facing it: only the cone's factor is left.
        const Vec3f position(2 * off_axis, 2 - 2 * along, 0);
        const Rgb e = unshadowed_irradiance(spot, position, (spot.position - position).normalized());
        const float share = std::clamp((along - 0.8f) / 0.15f, 0.0f, 1.0f);
        EXPECT_NEAR(e.x, 8 * share * share / 4, 2e-5f) << along;
    }
    spot.cos_inner = spot.cos_outer = 0.9f;
    const auto at = [&](float along) {
        const Vec3f position(2 * std::sqrt(1 - along * along), 2 - 2 * along, 0);
        return unshadowed_irradiance(spot, position, (spot.position - position).normalized()).x;
    };
    EXPECT_NEAR(at(0.91f), 2, 1e-4f) << "a cone with a sharp edge";
    EXPECT_EQ(at(0.89f), 0);
}

TEST(Lamps, RangeIsASmoothWindow) {
    Lamp lamp = point_lamp({0, 0, 0}, 16);
    lamp.range = 4;
    for (const float distance : {0.1f, 1.0f, 2.0f, 3.9f, 4.0f, 4.1f, 100.0f}) {
        const Rgb e = unshadowed_irradiance(lamp, {0, -distance, 0}, {0, 1, 0});
        const float share = distance / 4;
        const float window = std::clamp(1 - share * share * share * share, 0.0f, 1.0f);
        EXPECT_NEAR(e.x, 16 / (distance * distance) * window, 1e-5f * 16 / (distance * distance)) << distance;
    }
}

/// A floor with a plate above a part of it.
struct LitFloor {
    LitFloor() : scene(build()), tracer(scene) {}
    static Scene build() {
        Scene made;
        test::add_object(made, "floor", quad({-5, 0, -5}, {0, 0, 10}, {10, 0, 0}), 1);
        test::add_object(made, "plate", quad({0, 1, -5}, {0, 0, 10}, {5, 0, 0}), 2);
        return made;
    }
    [[nodiscard]] Rgb at(float x, float z, float random = 0.5f, const Vec2f& on_lamp = {0.5f, 0.5f}) const {
        // Triangle 0 holds x < z, triangle 1 the rest of the floor.
        return LampLight(scene, tracer).irradiance({{x, 0, z}, {0, 1, 0}, {0, 1, 0}, x < z ? 0u : 1u}, random, on_lamp);
    }
    Scene scene;
    Tracer tracer;
};

/// What a plane gets within the spot stays; no point of it gets more than 2 I / R^2.
TEST(Lamps, ASpotOnASurfaceCloseByIsSpreadEvenly) {
    Lamp lamp;
    lamp.direction = {0, -1, 0};
    lamp.intensity = {3, 3, 3};
    constexpr float spot_m = 0.5f;
    for (const float height : {0.001f, 0.1f, 0.4f}) {
        lamp.position = {0, height, 0};
        const double radius = std::sqrt(static_cast<double>(spot_m * spot_m - height * height));
        double flux = 0;
        constexpr int rings = 2000;
        for (int k = 0; k < rings; ++k) {
            const double r = radius * (k + 0.5) / rings;
            const Vec3f at(static_cast<float>(r), 0, 0), up(0, 1, 0);
            const float light = unshadowed_irradiance(lamp, at, up).x * spread_in_spot(lamp, at, up, spot_m);
            EXPECT_LE(light, 2 * lamp.intensity.x / (spot_m * spot_m) * 1.0001f);
            flux += 2 * pi * r * (radius / rings) * static_cast<double>(light);
        }
        EXPECT_NEAR(flux / (3 * 2 * pi * (1 - static_cast<double>(height / spot_m))), 1, 1e-3) << height;
        EXPECT_EQ(spread_in_spot(lamp, {0.51f, 0, 0}, {0, 1, 0}, spot_m), 1.0f);
    }
}

TEST(LampLight, ShadowsOfEveryKind) {
    LitFloor floor;
    EXPECT_TRUE(LampLight(floor.scene, floor.tracer).empty());
    EXPECT_EQ(floor.at(-2, 1), Rgb(0, 0, 0));
    Lamp sun = point_lamp({0, 0, 0}, 10);
    sun.kind = LampKind::directional;
    for (const Lamp& lamp : {sun, point_lamp({2, 3, 0}, 90)}) {
        floor.scene.lamps = {lamp};
        EXPECT_FALSE(LampLight(floor.scene, floor.tracer).empty());
        EXPECT_EQ(floor.at(3, 1), Rgb(0, 0, 0)) << "under the plate";
        const Rgb lit = floor.at(-3, 1);
        EXPECT_EQ(lit, unshadowed_irradiance(lamp, {-3, 0, 1}, {0, 1, 0}));
        EXPECT_GT(lit.x, 0);
    }
    floor.scene.lamps = {point_lamp({2, 0.5f, 0}, 1)};
    EXPECT_GT(floor.at(2, 0).x, 0) << "a lamp between floor and plate";
    floor.scene.lamps = {point_lamp({2, 1, 0}, 1)};
    EXPECT_GT(floor.at(2, 0).x, 0) << "a lamp on the plate's underside: the end of the ray is open";
}

TEST(LampLight, ShadingNormalsNeverLightTheBack) {
    LitFloor floor;
    floor.scene.lamps = {point_lamp({-4, -0.1f, 0}, 5)};
    const LightPoint at{{-3, 0, 0.5f}, {0, 1, 0}, Vec3f(-1, 0.1f, 0).normalized(), 0};
    EXPECT_GT(unshadowed_irradiance(floor.scene.lamps[0], at.position, at.shading_normal).x, 0);
    EXPECT_EQ(LampLight(floor.scene, floor.tracer).irradiance(at, 0.5f, {0.5f, 0.5f}), Rgb(0, 0, 0));
}

/// The mean over `random` is the sum over all lamps, shadows included, however few of the weak ones are tested at a
/// time.
TEST(LampLight, TheMeanOverRandomIsTheFullSum) {
    LitFloor floor;
    for (int k = 0; k < 150; ++k) {
        const float turn = static_cast<float>(k) * 0.7f;
        Lamp lamp = point_lamp({3 * std::cos(turn), 1.5f + static_cast<float>(k % 7) * 0.2f, 3 * std::sin(turn)},
                               1 + static_cast<float>(k % 11));
        if (k < 3) lamp.intensity *= 500;  // a few strong ones
        floor.scene.lamps.push_back(lamp);
    }
    for (const Vec2f& place : {Vec2f(-1, 2), Vec2f(1, 0.5f), Vec2f(-4, -4)}) {
        std::array<double, 3> mean{}, full{};
        constexpr int steps = 20000;
        for (int k = 0; k < steps; ++k) {
            const Rgb e = floor.at(place.x, place.y, (static_cast<float>(k) + 0.5f) / steps);
            for (int c = 0; c < 3; ++c) mean[static_cast<std::size_t>(c)] += static_cast<double>(e[c]) / steps;
        }
        LitFloor one;
        for (const Lamp& lamp : floor.scene.lamps) {
            one.scene.lamps = {lamp};
            const Rgb e = one.at(place.x, place.y);
            for (int c = 0; c < 3; ++c) full[static_cast<std::size_t>(c)] += static_cast<double>(e[c]);
        }
        EXPECT_GT(full[0], 0);
        for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(mean[c], full[c], 2e-3 * full[c]);
    }
}

TEST(LampLight, FewLampsAreAllTested) {
    LitFloor floor;
    floor.scene.lamps = {point_lamp({-2, 2, 0}, 100), point_lamp({-2, 2, 1}, 1), point_lamp({-2, 2, -1}, 1)};
    EXPECT_EQ(floor.at(-3, 1, 0.0f), floor.at(-3, 1, 0.99f));
}

}  // namespace
}  // namespace luxel
