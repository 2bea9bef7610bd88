/// Light through masks, sheets and panes against closed forms: lamps, and gathering from bright surfaces.
#include <gtest/gtest.h>

#include <cmath>

#include "baker/core/parallel.h"
#include "baker/core/sampling.h"
#include "baker/light/gather.h"
#include "baker/light/lamps.h"
#include "baker/light/patch_lamps.h"
#include "tests/support/see_through.h"

namespace luxel {
namespace {

using test::quad;
using test::SceneMaker;

LampRecord sun(double lux) {
    LampRecord lamp;
    lamp.kind = LampKind::directional;
    lamp.node_path = "sun";
    lamp.intensity = {lux, lux, lux};
    // It shines along -Z of its node: turned to shine along -Y.
    lamp.world = Imath::M44d(1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1);
    return lamp;
}

/// A level square of 4 x 4 m at height y.
test::MadeMesh level(float y) { return quad({-2, y, -2}, {0, 0, 4}, {4, 0, 0}); }

struct Gathered {
    std::unique_ptr<test::Prepared> made;
    std::vector<std::vector<Rgb>> pages;

    /// Calls use(middle of the texel, its irradiance) for the texels of object `object` in the open.
    template <class Use>
    void texels_of(std::uint32_t object, const Use& use) const {
        for (std::size_t page = 0; page < pages.size(); ++page)
            for (std::size_t t = 0; t < pages[page].size(); ++t) {
                const PageTexels& content = made->texels.pages[page];
                const Texel& texel = content.texels[t];
                if (made->atlas.charts[texel.chart].object != object || !content.can_send(texel)) continue;
                const Fragment& fragment = content.fragments[texel.first_fragment];
                const Vec2f b = fragment_polygon(made->scene, made->atlas, fragment).centroid();
                use(surface_position(made->scene, fragment.triangle, b), pages[page][t]);
            }
    }
};

Gathered gather(SceneMaker& maker, const GatherOptions& options, double texels_per_metre = 8) {
    Gathered out;
    out.made = test::prepare(test::build_with_pictures(maker), {.texels_per_metre = texels_per_metre});
    const test::Prepared& made = *out.made;
    const EmitterSet emitters(made.scene, made.atlas, made.patches);
    const std::vector<Rgb> reflected(made.patches.count(), Rgb(0, 0, 0));
    const RadiosityDetail detail(reflected);
    const LightGuides guides;
    const GatherInput input{made.scene, made.atlas, made.texels, made.patches, *made.tracer, emitters, detail, guides};
    for (std::uint32_t page = 0; page < made.texels.pages.size(); ++page)
        out.pages.push_back(gather_page(input, page, options, nullptr)->irradiance());
    return out;
}

TEST(SeeThroughLight, AMaskedCheckerIsItsPatternOnTheFloor) {
    SceneMaker maker;
    maker.add("floor", level(0)).add("mask", level(1));
    test::checker_mask(maker, 0.5f).add_lamp(sun(100));
    const Gathered light = gather(maker, {.rays = 2, .lamp_points = 16});
    std::size_t lit = 0, dark = 0;
    light.texels_of(0, [&](const Vec3f& p, const Rgb& e) {
        const double x = (static_cast<double>(p.x) + 2) / 0.5, z = (static_cast<double>(p.z) + 2) / 0.5;
        // The lamp's points are anywhere in the texel: leave out those that the pattern cuts.
        if (std::abs(x - std::round(x)) < 0.14 || std::abs(z - std::round(z)) < 0.14) return;
        const bool is_solid = static_cast<int>(std::floor(x) + std::floor(z)) % 2 == 0;
        ++(is_solid ? dark : lit);
        EXPECT_NEAR(e.x, is_solid ? 0.0f : 100.0f, 1e-4f) << p.x << ' ' << p.z;
    });
    EXPECT_GT(lit, 100u);
    EXPECT_GT(dark, 100u);
}

TEST(SeeThroughLight, SheetsAndPanesWeakenLampsExactly) {
    for (const bool is_sun : {true, false})
        for (int panes = 0; panes <= 3; ++panes) {
            SceneMaker maker;
            maker.add("floor", level(0));
            Rgb expected(1, 1, 1);
            for (int k = 0; k < panes; ++k) {
                maker.add("pane " + std::to_string(k), quad({-9, 1 + 0.1f * static_cast<float>(k), -9}, {0, 0, 18}, {18, 0, 0}));
                if (k == 1) test::blend(maker, 0.3), expected *= 0.7f;
                else test::glass(maker, {0.9, 0.5, 0.1}), expected *= Rgb(0.9f, 0.5f, 0.1f);
            }
            LampRecord lamp = sun(50);
            if (!is_sun) lamp.kind = LampKind::point, lamp.world[3][1] = 2;
            const Scene scene = test::build_with_pictures(maker.add_lamp(lamp));
            const Tracer tracer(scene);
            const LampLight light(scene, tracer);
            for (const Vec3f& at : {Vec3f(0.3f, 0, 0.7f), Vec3f(-1, 0, 1.5f), Vec3f(0.5f, 0, 1)}) {
                const LightPoint point{at - to_float(scene.origin), {0, 1, 0}, {0, 1, 0}, 0};
                const Rgb open = unshadowed_irradiance(scene.lamps[0], point.position, point.shading_normal);
                for (int c = 0; c < 3; ++c) {
                    EXPECT_NEAR(light.irradiance(point, 0.5f, {0.5f, 0.5f})[c], open[c] * expected[c], 2e-6f * open[c]);
                    EXPECT_NEAR(light.irradiance_of(0, point, {0.5f, 0.5f})[c], open[c] * expected[c], 2e-6f * open[c]);
                }
            }
        }
}

TEST(SeeThroughLight, ManyWeakLampsThroughAPane) {
    SceneMaker maker;
    maker.add("floor", level(0)).add("pane", quad({-9, 1, -9}, {0, 0, 18}, {18, 0, 0}));
    test::glass(maker, {0.5, 1, 0.25});
    for (int k = 0; k < 60; ++k) {
        LampRecord lamp = sun(10);
        lamp.kind = LampKind::point;
        lamp.world[3][0] = std::cos(k), lamp.world[3][1] = 2 + 0.01 * k, lamp.world[3][2] = std::sin(k);
        maker.add_lamp(lamp);
    }
    const Scene scene = test::build_with_pictures(maker);
    const Tracer tracer(scene);
    const LightPoint at{Vec3f(0.3f, 0, 0.7f) - to_float(scene.origin), {0, 1, 0}, {0, 1, 0}, 0};
    double sum = 0, full = 0;
    for (const Lamp& lamp : scene.lamps) full += static_cast<double>(unshadowed_irradiance(lamp, at.position, at.shading_normal).x);
    for (int k = 0; k < 1000; ++k) {
        const Rgb e = LampLight(scene, tracer).irradiance(at, (static_cast<float>(k) + 0.5f) / 1000, {0.5f, 0.5f});
        EXPECT_NEAR(e.y, 2 * e.x, 1e-5f * e.x);
        EXPECT_NEAR(e.z, 0.5f * e.x, 1e-5f * e.x);
        sum += static_cast<double>(e.x) / 1000;
    }
    EXPECT_NEAR(sum, full / 2, 2e-3 * full);
}

/// A floor under a glowing ceiling, with a pane between that is as large: what comes from the ceiling is tinted.
TEST(SeeThroughLight, GatheredLightIsTinted) {
    for (const bool aim : {false, true}) {
        const auto mean = [&](bool with_pane) {
            SceneMaker maker;
            test::MadeMaterial glow{{0, 0, 0}, {1, 1, 1}, false};
            maker.add("floor", quad({-0.5f, 0, -0.5f}, {0, 0, 1}, {1, 0, 0}));
            maker.add("lamp", quad({-0.25f, 1, -0.25f}, {0.5f, 0, 0}, {0, 0, 0.5f}), glow);
            if (with_pane) maker.add("pane", quad({-9, 0.5f, -9}, {0, 0, 18}, {18, 0, 0})), test::glass(maker, {0.9, 0.5, 0}, 0.8);
            const Gathered light = gather(maker, {.rays = 1024, .aim_at_emitters = aim});
            Vec3d sum(0, 0, 0);
            int count = 0;
            light.texels_of(0, [&](const Vec3f&, const Rgb& e) { sum += to_double(e), ++count; });
            return sum / count;
        };
        const Vec3d open = mean(false), through = mean(true);
        EXPECT_GT(open.x, 0.1);
        // 64 texels of 1,024 rays of which a tenth meet the lamp, more where aimed: about 1 % at two standard errors.
        EXPECT_NEAR(through.x / open.x, 0.8 * 0.9, 0.03);
        EXPECT_NEAR(through.y / open.y, 0.8 * 0.5, 0.02);
        EXPECT_EQ(through.z, 0);
    }
}

/// A glowing sheet of alpha a sends a of what an opaque one would, whichever rays find it.
TEST(SeeThroughLight, AGlowingSheetSendsItsAlpha) {
    const auto mean = [&](double alpha) {
        SceneMaker maker;
        test::MadeMaterial glow{{0, 0, 0}, {1, 1, 1}, false};
        maker.add("floor", quad({-0.5f, 0, -0.5f}, {0, 0, 1}, {1, 0, 0}));
        maker.add("lamp", quad({-0.5f, 1, -0.5f}, {1, 0, 0}, {0, 0, 1}), glow);
        test::blend(maker, alpha);
        const Gathered light = gather(maker, {.rays = 1024});
        double sum = 0;
        int count = 0;
        light.texels_of(0, [&](const Vec3f&, const Rgb& e) { sum += static_cast<double>(e.x), ++count; });
        return sum / count;
    };
    EXPECT_NEAR(mean(0.4) / mean(1), 0.4, 0.01);
}

TEST(SeeThroughLight, ThreadsChangeNothing) {
    const auto run = [](unsigned threads) {
        const ThreadLimit limit(threads);
        SceneMaker maker;
        test::MadeMaterial glow{{0, 0, 0}, {1, 1, 1}, false};
        maker.add("floor", level(0)).add("lamp", quad({-1, 2, -1}, {2, 0, 0}, {0, 0, 2}), glow);
        maker.add("mask", level(1)), test::checker_mask(maker, 0.3f);
        maker.add("pane", level(0.5f)), test::glass(maker, {0.9, 0.8, 0.7}, 0.5);
        return gather(maker.add_lamp(sun(3)), {.rays = 64}, 4).pages;
    };
    EXPECT_EQ(run(1), run(2));
}

}  // namespace
}  // namespace luxel
