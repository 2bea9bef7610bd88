/// Rays at surfaces that let light through: masks cut exactly, sheets stop the right share, panes tint.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "baker/trace/tracer.h"
#include "tests/support/see_through.h"

namespace luxel {
namespace {

using test::add_quad;
using test::MadeMesh;
using test::quad;
using test::SceneMaker;

constexpr float far = std::numeric_limits<float>::infinity();

/// A level sheet of 8 x 8 m at height y, around the origin.
MadeMesh sheet(float y) { return quad({-4, y, -4}, {0, 0, 8}, {8, 0, 0}); }

/// `count` rays downwards from height 5 and a little askew, over 6 x 6 m.
std::vector<TraceRay> falling_rays(std::size_t count, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> place(-3, 3), lean(-0.2f, 0.2f);
    std::vector<TraceRay> rays(count);
    for (TraceRay& ray : rays)
        ray = {{place(random), 5, place(random)}, Vec3f(lean(random), -1, lean(random)).normalized(), none};
    return rays;
}

std::vector<TraceHit> hits_of(const Tracer& tracer, const std::vector<TraceRay>& rays) {
    std::vector<TraceHit> hits(rays.size());
    tracer.first_hits(rays, hits);
    return hits;
}

bool equal(const TraceHit& a, const TraceHit& b) {
    return a.triangle == b.triangle && a.b1 == b.b1 && a.b2 == b.b2 && a.distance_m == b.distance_m && a.front == b.front &&
           a.tint == b.tint;
}

/// Share of hits on triangles [first, first + 2).
double share_on(const std::vector<TraceHit>& hits, std::uint32_t first) {
    std::size_t on = 0;
    for (const TraceHit& hit : hits) on += hit.triangle == first || hit.triangle == first + 1;
    return static_cast<double>(on) / static_cast<double>(hits.size());
}

TEST(SeeThrough, OpaqueScenesHaveNone) {
    SceneMaker maker;
    maker.add("sheet", sheet(1));
    test::blend(maker, 1);  // covers everywhere
    const Scene scene = maker.build();
    const Tracer tracer(scene);
    EXPECT_FALSE(tracer.is_see_through());
    EXPECT_EQ(tracer.transmittance({{0, 5, 1}, {0, -1, 0}, none}, far), Rgb(0, 0, 0));
    EXPECT_EQ(tracer.transmittance({{5, 5, 1}, {0, -1, 0}, none}, far), Rgb(1, 1, 1));
}

TEST(SeeThrough, MasksCutEveryKindOfRayExactly) {
    SceneMaker maker;
    maker.add("floor", sheet(0)).add("mask", sheet(1));
    const Scene scene = test::build_with_pictures(test::checker_mask(maker, 0.5f));
    const Tracer tracer(scene);
    ASSERT_TRUE(tracer.is_see_through());
    const auto rays = falling_rays(4000, 1);
    const auto hits = hits_of(tracer, rays);
    std::size_t met = 0;
    for (std::size_t k = 0; k < rays.size(); ++k) {
        const Vec3f at = rays[k].origin + rays[k].direction * (-4 / rays[k].direction.y);
        const double row = (static_cast<double>(at.z) + 4) / 0.5, column = (static_cast<double>(at.x) + 4) / 0.5;
        if (std::abs(row - std::round(row)) < 1e-4 || std::abs(column - std::round(column)) < 1e-4) continue;
        const bool is_solid = static_cast<long>(std::floor(row) + std::floor(column)) % 2 == 0;
        EXPECT_EQ(hits[k].triangle / 2, is_solid ? 1u : 0u);
        EXPECT_TRUE(equal(hits[k], tracer.first_hit(rays[k])));
        EXPECT_EQ(hits[k].tint, Rgb(1, 1, 1));
        const float above_floor = hits[k].triangle / 2 == 0 ? hits[k].distance_m * 0.999f : 4.5f;
        EXPECT_EQ(tracer.occluded(rays[k], above_floor), is_solid);
        EXPECT_EQ(tracer.transmittance(rays[k], above_floor), is_solid ? Rgb(0, 0, 0) : Rgb(1, 1, 1));
        met += is_solid;
    }
    EXPECT_GT(met, rays.size() / 3);
}

TEST(SeeThrough, SheetsStopTheShareOfTheirAlpha) {
    for (const double alpha : {0.1, 0.5, 0.9}) {
        SceneMaker maker;
        maker.add("floor", sheet(0)).add("sheet", sheet(1));
        const Scene scene = test::blend(maker, alpha).build();
        const Tracer tracer(scene);
        const auto rays = falling_rays(20000, 2);
        const auto hits = hits_of(tracer, rays);
        EXPECT_NEAR(share_on(hits, 2), alpha, 4 * std::sqrt(alpha * (1 - alpha) / 20000));
        EXPECT_NEAR(share_on(hits, 0), 1 - alpha, 4 * std::sqrt(alpha * (1 - alpha) / 20000));
        for (std::size_t k = 0; k < 100; ++k) {
            EXPECT_EQ(hits[k].tint, Rgb(1, 1, 1));
            const Rgb left = tracer.transmittance(rays[k], 4.8f);
            for (int c = 0; c < 3; ++c) EXPECT_NEAR(left[c], 1 - alpha, 1e-6);
            EXPECT_TRUE(tracer.occluded(rays[k], 4.8f)) << "a sheet is something";
        }
    }
}

TEST(SeeThrough, BlendTakesTheBaseColourIfAsked) {
    SceneMaker maker;
    maker.add("floor", sheet(0)).add("sheet", sheet(1));
    const Scene scene = test::build_with_pictures(test::blend(maker, 0.25, {1, 0.5, 0}), {.blend_colours = true});
    const Tracer tracer(scene);
    const TraceRay ray{{0.1f, 5, 0.3f}, {0, -1, 0}, none};
    const Rgb left = tracer.transmittance(ray, 4.8f);
    EXPECT_NEAR(left.x, 0.75f, 1e-6f);
    EXPECT_NEAR(left.y, 0.375f, 1e-6f);
    EXPECT_EQ(left.z, 0);
    for (const TraceHit& hit : hits_of(tracer, falling_rays(200, 3)))
        EXPECT_EQ(hit.tint, hit.triangle < 2 ? Rgb(1, 0.5f, 0) : Rgb(1, 1, 1));
}

TEST(SeeThrough, PanesMultiplyTheirTints) {
    const std::array<std::array<double, 3>, 3> tints{{{1, 0.5, 0.25}, {0.5, 1, 0.75}, {0.9, 0.8, 0.7}}};
    SceneMaker maker;
    maker.add("floor", sheet(0));
    Rgb product(1, 1, 1);
    for (std::size_t k = 0; k < 3; ++k) {
        maker.add("pane " + std::to_string(k), sheet(1 + static_cast<float>(k)));
        test::glass(maker, tints[k]);
        for (int c = 0; c < 3; ++c) product[c] *= static_cast<float>(tints[k][static_cast<std::size_t>(c)]);
    }
    const Scene scene = maker.build();
    const Tracer tracer(scene);
    const auto rays = falling_rays(500, 4);
    const auto hits = hits_of(tracer, rays);
    for (std::size_t k = 0; k < rays.size(); ++k) {
        EXPECT_LT(hits[k].triangle, 2u) << "clear panes stop nothing";
        for (int c = 0; c < 3; ++c) {
            EXPECT_NEAR(hits[k].tint[c], product[c], 1e-6f);
            EXPECT_NEAR(tracer.transmittance(rays[k], hits[k].distance_m * 0.99f)[c], product[c], 1e-6f);
        }
        EXPECT_TRUE(equal(hits[k], tracer.first_hit(rays[k])));
    }
    // Only what is between counts.
    const Rgb one = tracer.transmittance({{0.3f, 2.5f, 0.1f}, {0, 1, 0}, none}, 1);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(one[c], static_cast<float>(tints[2][static_cast<std::size_t>(c)]), 1e-6f);
}

TEST(SeeThrough, TheMeanOfHalfTransparentTintedPanes) {
    SceneMaker maker;
    maker.add("floor", sheet(0));
    for (int k = 0; k < 4; ++k) {
        maker.add("pane " + std::to_string(k), sheet(1 + 0.5f * static_cast<float>(k)));
        test::glass(maker, {0.9, 0.6, 0.3}, 0.7);
    }
    const Scene scene = maker.build();
    const Tracer tracer(scene);
    const auto rays = falling_rays(40000, 5);
    const auto hits = hits_of(tracer, rays);
    for (int c = 0; c < 3; ++c) {
        const double tint = c == 0 ? 0.9 : c == 1 ? 0.6 : 0.3;
        double sum = 0, squares = 0;
        for (const TraceHit& hit : hits) {
            const double light = hit.triangle < 2 ? static_cast<double>(hit.tint[c]) : 0.0;
            sum += light, squares += light * light;
        }
        const double n = static_cast<double>(hits.size()), mean = sum / n;
        EXPECT_NEAR(mean, std::pow(0.7 * tint, 4), 4 * std::sqrt((squares / n - mean * mean) / n));
    }
    // Each pane is met as often as what comes to it says.
    for (std::uint32_t k = 0; k < 4; ++k) {
        const double expected = std::pow(0.7, 3 - k) * 0.3;
        EXPECT_NEAR(share_on(hits, 2 + 2 * k), expected, 4 * std::sqrt(expected / 40000));
    }
}

TEST(SeeThrough, ABoxOfGlassIsTwoPanes) {
    SceneMaker maker;
    maker.add("box", test::moved(test::box(2, 2, 2), {-1, 1, -1}));
    test::glass(maker, {0.5, 1, 0.8});
    const Scene scene = maker.build();
    const Tracer tracer(scene);
    const TraceRay ray{{0.3f, 5, 0.1f}, {0, -1, 0}, none};
    EXPECT_EQ(tracer.first_hit(ray).triangle, none);
    EXPECT_NEAR(tracer.first_hit(ray).tint.x, 0.25f, 1e-6f);
    EXPECT_NEAR(tracer.transmittance(ray, far).z, 0.64f, 1e-6f);
}

TEST(SeeThrough, AnEdgeBetweenTwoTrianglesIsOnePane) {
    SceneMaker maker;
    maker.add("sheet", sheet(1));
    const Scene scene = test::blend(maker, 0.5).build();
    const Tracer tracer(scene);
    for (int k = -31; k <= 31; ++k) {
        const float at = static_cast<float>(k) / 8;  // exactly on the diagonal
        EXPECT_NEAR(tracer.transmittance({{at, 5, at}, {0, -1, 0}, none}, 9).x, 0.5f, 1e-6f) << at;
    }
}

TEST(SeeThrough, ADecalOnItsWallIsMetByItsAlpha) {
    for (const bool decal_first : {false, true}) {
        SceneMaker maker;
        const auto decal = [&] { maker.add("decal", sheet(1)), test::blend(maker, 0.3); };
        if (decal_first) decal();
        maker.add("wall", sheet(1));
        if (!decal_first) decal();
        const Scene scene = maker.build();
        const Tracer tracer(scene);
        const auto hits = hits_of(tracer, falling_rays(10000, 6));
        EXPECT_NEAR(share_on(hits, decal_first ? 0 : 2), 0.3, 4 * std::sqrt(0.21 / 10000));
        EXPECT_NEAR(share_on(hits, decal_first ? 2 : 0), 0.7, 4 * std::sqrt(0.21 / 10000));
    }
}

TEST(SeeThrough, ARayLeavesItsOwnPane) {
    SceneMaker maker;
    maker.add("pane", sheet(1)), test::glass(maker, {0.5, 0.5, 0.5}, 0.5);
    const Scene scene = maker.build();
    const Tracer tracer(scene);
    for (const std::uint32_t own : {0u, 1u}) {
        const TraceRay ray{{own ? 1.0f : -1.0f, 1, own ? -1.0f : 1.0f}, Vec3f(0.1f, 1, 0.1f).normalized(), own};
        EXPECT_EQ(tracer.first_hit(ray).triangle, none);
        EXPECT_EQ(tracer.first_hit(ray).tint, Rgb(1, 1, 1));
        EXPECT_EQ(tracer.transmittance(ray, far), Rgb(1, 1, 1));
    }
}

/// Neither the packet, nor the order of rays, nor other objects decide what a ray does.
TEST(SeeThrough, HitsBelongToTheRay) {
    const auto build = [](bool crowded) {
        SceneMaker maker;
        if (crowded) maker.add("aside", quad({50, 0, 0}, {0, 0, 1}, {1, 0, 0})), test::blend(maker, 0.5);
        maker.add("floor", sheet(0));
        for (int k = 0; k < 5; ++k) {
            maker.add("pane " + std::to_string(k), sheet(1 + 0.5f * static_cast<float>(k)));
            test::glass(maker, {0.9 - 0.1 * k, 0.7, 0.5 + 0.1 * k}, 0.6);
        }
        return maker.build();
    };
    const Scene scene = build(false), crowded = build(true);
    const Tracer tracer(scene), other(crowded);
    // Origins must be the same bits in both.
    ASSERT_EQ(scene.origin, Vec3d(0, 0, 0));
    const Vec3f shift = to_float(scene.origin - crowded.origin);
    const auto rays = falling_rays(999, 7);
    auto reversed = rays;
    std::reverse(reversed.begin(), reversed.end());
    const auto hits = hits_of(tracer, rays), backwards = hits_of(tracer, reversed);
    for (std::size_t k = 0; k < rays.size(); ++k) {
        EXPECT_TRUE(equal(hits[k], tracer.first_hit(rays[k])));
        EXPECT_TRUE(equal(hits[k], backwards[rays.size() - 1 - k]));
        if (shift != Vec3f(0, 0, 0)) continue;
        const TraceHit there = other.first_hit(rays[k]);
        EXPECT_EQ(there.triangle, hits[k].triangle + 2);
        EXPECT_EQ(there.tint, hits[k].tint);
    }
}

TEST(SeeThrough, TintedRaysSurviveByTheMean) {
    std::size_t survived = 0;
    const auto rays = falling_rays(20000, 8);
    for (const TraceRay& ray : rays) survived += survives_tint(ray, {0.9f, 0.6f, 0.3f});
    EXPECT_NEAR(static_cast<double>(survived) / 20000, 0.6, 4 * std::sqrt(0.24 / 20000));
    EXPECT_TRUE(survives_tint(rays[0], {1, 1, 1}));
    EXPECT_FALSE(survives_tint(rays[0], {0, 0, 0}));
}

/// Under a one-sided leaf or inside a one-sided glass case there are only backs to see: that is no solid.
TEST(SeeThrough, NothingIsHiddenUnderLeavesAndGlass) {
    const auto hidden = [](bool is_glass) {
        SceneMaker maker;
        maker.add("floor", quad({-2, 0, -2}, {0, 0, 4}, {4, 0, 0}));
        maker.add("case", test::moved(test::box(1, 1, 1), {-0.5f, -0.01f, -0.5f}));
        if (is_glass) test::glass(maker, {0.9, 0.9, 0.9}, 0.1);
        const auto made = test::prepare(maker.build());
        double area = 0;
        for (const PageTexels& page : made->texels.pages)
            for (const Texel& texel : page.texels)
                if (made->atlas.charts[texel.chart].object == 0) area += static_cast<double>(texel.area_m2 - texel.visible_m2);
        return area;
    };
    EXPECT_NEAR(hidden(false), 1, 0.02) << "a solid box hides what it stands on";
    EXPECT_EQ(hidden(true), 0);
}

/// The area of see-through surfaces is what is there of them.
TEST(SeeThrough, AreasAreWhatIsThere) {
    SceneMaker maker;
    maker.add("mask", quad({0, 0, 0}, {0, 0, 2}, {2, 0, 0}));
    test::checker_mask(maker, 0.37f);
    maker.add("sheet", quad({3, 0, 0}, {0, 0, 2}, {2, 0, 0}));
    test::blend(maker, 0.25, {0.5, 0.5, 0.5});
    maker.add("pane", quad({6, 0, 0}, {0, 0, 2}, {2, 0, 0}));
    test::glass(maker, {1, 1, 1});
    const auto made = test::prepare(test::build_with_pictures(maker));
    std::array<double, 3> area{};
    for (PatchNumber p = 0; p < made->patches.count(); ++p)
        area[made->object_of(p)] += static_cast<double>(made->patches.patches[p].area_m2);
    double solid = 0;
    constexpr int fine = 1000;
    for (int y = 0; y < fine; ++y)
        for (int x = 0; x < fine; ++x)
            solid += (static_cast<int>((y + 0.5) / fine * 2 / 0.37) + static_cast<int>((x + 0.5) / fine * 2 / 0.37)) % 2 == 0;
    EXPECT_NEAR(area[0], 4 * solid / fine / fine, 0.04);
    EXPECT_NEAR(area[1], 1, 1e-5);
    EXPECT_GT(area[2], 0) << "a clear pane has patches";
    EXPECT_LT(area[2], 0.01);
}

}  // namespace
}  // namespace luxel
