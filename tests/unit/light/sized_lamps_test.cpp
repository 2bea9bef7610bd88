/// Lamps with a size: closed forms of spheres and disks, cut by horizons and edges.
#include <gtest/gtest.h>

#include <cmath>

#include "baker/light/lamps.h"
#include "tests/support/scenes.h"

namespace luxel {
namespace {

using test::quad;

constexpr float pi_f = 3.14159265f;

Lamp ball(const Vec3f& position, float candela, float radius) {
    Lamp lamp;
    lamp.position = position;
    lamp.direction = {0, -1, 0};
    lamp.intensity = {candela, 2 * candela, 3 * candela};
    lamp.radius = radius;
    return lamp;
}

Lamp sun_above(float lux, float degrees) {
    Lamp lamp = ball({0, 0, 0}, lux, 0);
    lamp.kind = LampKind::directional;
    lamp.sin_radius = std::sin(degrees * pi_f / 360);
    return lamp;
}

/// Share of the cosine-weighted hemisphere of +Y that lies within the cone, by quadrature over the cone.
double cone_by_quadrature(double cosine, double sine) {
    const double across = std::sqrt(1 - cosine * cosine), deepest = std::sqrt(1 - sine * sine);
    constexpr int steps = 600;
    double sum = 0;
    for (int i = 0; i < steps; ++i)
        for (int j = 0; j < steps; ++j) {
            const double height = deepest + (1 - deepest) * (i + 0.5) / steps, angle = 2 * pi_f * (j + 0.5) / steps;
            sum += std::max(0.0, height * cosine + std::sqrt(1 - height * height) * std::cos(angle) * across);
        }
    return sum * (1 - deepest) * 2 / (static_cast<double>(steps) * steps);
}

TEST(SizedLamps, FormFactorOfAConeAndTheHorizon) {
    for (const float sine : {0.02f, 0.3f, 0.7f, 0.99f})
        for (const float cosine : {1.0f, 0.8f, 0.31f, 0.1f, 0.0f, -0.015f, -0.25f, -0.6f, -0.98f, -1.0f}) {
            const double expected = cone_by_quadrature(static_cast<double>(cosine), static_cast<double>(sine));
            EXPECT_NEAR(cone_form_factor(cosine, sine), expected, 2e-4 * sine * sine + 1e-7) << sine << " " << cosine;
        }
}

TEST(SizedLamps, ASphereAboveTheHorizonGivesWhatAPointGives) {
    for (const float distance : {0.6f, 2.0f, 50.0f})
        for (const float angle : {0.0f, 0.4f, 0.9f}) {
            const Lamp lamp = ball({0, distance, 0}, 100, 0.3f);
            const Vec3f normal(std::sin(angle), std::cos(angle), 0);
            Lamp point = lamp;
            point.radius = 0;
            const Rgb expected = unshadowed_irradiance(point, {0, 0, 0}, normal),
                      found = unshadowed_irradiance(lamp, {0, 0, 0}, normal);
            for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c], expected[c], 1e-5f * expected[c]);
        }
}

/// One triangle far below, so that a tracer has something to hold.
struct Nothing {
    Nothing() : scene(build()), tracer(scene) {}
    static Scene build() {
        Scene made;
        test::add_object(made, "far", quad({-1, -1000, -1}, {0, 0, 2}, {2, 0, 0}), 1);
        return made;
    }
    [[nodiscard]] double mean(const Lamp& lamp, const LightPoint& at) {
        scene.lamps = {lamp};
        const LampLight light(scene, tracer);
        constexpr int steps = 64;
        double sum = 0;
        for (int i = 0; i < steps; ++i)
            for (int j = 0; j < steps; ++j)
                sum += static_cast<double>(
                    light
                        .irradiance(at, 0.5f,
                                    {(static_cast<float>(i) + 0.5f) / steps, (static_cast<float>(j) + 0.5f) / steps})
                        .x);
        return sum / (steps * steps);
    }
    Scene scene;
    Tracer tracer;
};

TEST(SizedLamps, TheMeanOverTheLampIsTheClosedForm) {
    Nothing nothing;
    const Vec3f up(0, 1, 0);
    struct Case {
        const char* name;
        Lamp lamp;
        Vec3f normal;
    };
    Lamp spot = ball({0.2f, 3, 0}, 50, 0.4f);
    spot.kind = LampKind::spot;
    spot.cos_inner = 0.999f, spot.cos_outer = 0.9f;
    spot.range = 5;
    for (const Case& c :
         {Case{"above", ball({0.5f, 1, 0.2f}, 10, 0.3f), up}, Case{"low", ball({2, 0.1f, 0}, 10, 0.5f), up},
          Case{"below", ball({2, -0.3f, 0}, 10, 0.5f), up}, Case{"touching", ball({0, 0.5001f, 0}, 10, 0.5f), up},
          Case{"spot", spot, up}, Case{"inside", ball({0, 0.1f, 0}, 10, 0.5f), up},
          Case{"sun", sun_above(1000, 20), Vec3f(0.6f, 0.8f, 0)},
          Case{"setting sun", sun_above(1000, 20), Vec3f(0.99f, 0.1f, 0).normalized()}}) {
        // The geometric normal leaves room for all that the shading normal may see.
        const LightPoint at{{0, 0, 0}, c.normal, c.normal, none};
        const double expected = static_cast<double>(unshadowed_irradiance(c.lamp, at.position, c.normal).x);
        EXPECT_GT(expected, 0) << c.name;
        EXPECT_NEAR(nothing.mean(c.lamp, {at.position, at.geometric_normal, at.shading_normal, 0}), expected,
                    3e-3 * expected)
            << c.name;
    }
    EXPECT_FLOAT_EQ(unshadowed_irradiance(ball({0, 0.1f, 0}, 10, 0.5f), {0, 0, 0}, up).x, 10 / 0.25f)
        << "pi times its luminance";
}

/// A half plane at height h under a sun straight above: the shadow's edge is as wide as the disk is there, and its
/// profile is the area of a disk on one side of a chord.
TEST(SizedLamps, PenumbraOfTheSunBehindAnEdge) {
    Scene scene;
    test::add_object(scene, "floor", quad({-50, 0, -50}, {0, 0, 100}, {100, 0, 0}), 1);
    test::add_object(scene, "edge", quad({0, 2, -50}, {0, 0, 100}, {50, 0, 0}), 2);
    const Tracer tracer(scene);
    scene.lamps = {sun_above(1000, 6)};
    const LampLight light(scene, tracer);
    const float half_width = 2 * std::tan(3 * pi_f / 180);
    const auto mean_at = [&](float x) {
        double sum = 0;
        constexpr int steps = 100;
        for (int i = 0; i < steps; ++i)
            for (int j = 0; j < steps; ++j)
                sum += static_cast<double>(
                    light
                        .irradiance({{x, 0, 1}, {0, 1, 0}, {0, 1, 0}, x < 1 ? 0u : 1u}, 0.5f,
                                    {(static_cast<float>(i) + 0.5f) / steps, (static_cast<float>(j) + 0.5f) / steps})
                        .x);
        return sum / (steps * steps);
    };
    for (const float t : {-1.05f, -0.9f, -0.5f, 0.0f, 0.4f, 0.95f, 1.05f}) {
        const double s = std::clamp(static_cast<double>(t), -1.0, 1.0);
        const double lit = (std::acos(s) - s * std::sqrt(1 - s * s)) / static_cast<double>(pi_f);
        EXPECT_NEAR(mean_at(t * half_width), 1000 * lit, 4) << t;
    }
}

TEST(SizedLamps, APointIsTestedOnceWhateverTheNumbers) {
    Nothing nothing;
    nothing.scene.lamps = {ball({0, 1, 0}, 10, 0)};
    const LampLight light(nothing.scene, nothing.tracer);
    const LightPoint at{{0, 0, 0}, {0, 1, 0}, {0, 1, 0}, 0};
    EXPECT_EQ(light.irradiance(at, 0.5f, {0.1f, 0.9f}), light.irradiance(at, 0.5f, {0.7f, 0.2f}));
    EXPECT_EQ(light.irradiance_of(0, at, {0.1f, 0.9f}),
              unshadowed_irradiance(nothing.scene.lamps[0], at.position, at.shading_normal));
}

}  // namespace
}  // namespace luxel
