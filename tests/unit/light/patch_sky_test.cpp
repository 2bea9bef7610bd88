/// Light of the sky on patches and texels: open planes, shadows of a small bright disk, and what binning costs.
#include "baker/light/patch_sky.h"

#include <gtest/gtest.h>

#include <cmath>

#include "baker/core/sobol.h"
#include "baker/formfactors/sky_bins.h"
#include "baker/formfactors/sky_view.h"
#include "baker/light/gather.h"
#include "baker/light/sky.h"
#include "baker/light/sky_split.h"
#include "baker/patches/patch_sampler.h"
#include "tests/support/scenes.h"

namespace luxel {
namespace {

using test::quad;
using test::SceneMaker;

std::unique_ptr<test::Prepared> floor_under_plate() {
    return test::prepare(SceneMaker()
                             .add("floor", quad({-3, 0, -3}, {0, 0, 6}, {6, 0, 0}))
                             .add("plate", quad({-1, 1, -1}, {0, 0, 2}, {2, 0, 0}), {{0.5, 0.5, 0.5}, {0, 0, 0}, true})
                             .build());
}

std::vector<Rgb> light_of(const test::Prepared& made, const SkySplit& split, std::uint32_t rays) {
    const auto count = static_cast<PatchNumber>(made.patches.count());
    const SkyCounts view = count_sky_rays(made.scene, made.atlas, made.patches, *made.tracer, 0, count, {rays, 0});
    std::vector<Rgb> light;
    std::size_t at = 0;
    for (const std::uint16_t bins : view.bins_of_patch) {
        light.push_back(binned_irradiance(split.bins, std::span(view.bins).subspan(at, bins),
                                          std::span(view.counts).subspan(at, bins), rays));
        at += bins;
    }
    add_bright_sky(made.scene, made.atlas, made.patches, *made.tracer, split.bright, 64, light);
    return light;
}

/// Mean irradiance of a patch by rays aimed at the whole sky.
double truth_of(const test::Prepared& made, const Sky& sky, PatchNumber patch) {
    const PatchSampler sampler(made.scene, made.atlas, made.patches, patch);
    const SobolSequence places(patch);
    const ShuffledSobol aims(patch + 1000000ull);
    constexpr std::uint32_t rays = 16384;
    double sum = 0;
    for (std::uint32_t k = 0; k < rays; ++k) {
        const auto u = places.point(k), w = aims.point(k);
        const SurfacePoint at = sampler.point(u[0], u[1]);
        const Sky::Sample aim = sky.sample(w[0], w[1]);
        const float cosine = aim.direction.dot(at.normal);
        if (cosine <= 0 || !(aim.density > 0)) continue;
        if (!made.tracer->occluded({at.position + at.normal * 1e-4f, aim.direction, at.triangle}, INFINITY))
            sum += static_cast<double>(sky.radiance(aim.direction).x * cosine / aim.density);
    }
    return sum / rays;
}

/// A dim sky with a disk of 3 degrees and 2000 times its brightness, 50 degrees up.
SkyMap sunny() {
    SkyMap map{256, 128, {}, 0};
    const Vec3f sun(std::cos(0.87f), std::sin(0.87f), 0);
    for (std::uint32_t y = 0; y < map.height; ++y)
        for (std::uint32_t x = 0; x < map.width; ++x) {
            const double down = 3.14159265358979 * (y + 0.5) / map.height,
                         along = 2 * 3.14159265358979 * ((x + 0.5) / map.width - 0.5);
            const Vec3f d(static_cast<float>(std::sin(down) * std::cos(along)), static_cast<float>(std::cos(down)),
                          static_cast<float>(std::sin(down) * std::sin(along)));
            const float nits = d.dot(sun) > std::cos(0.026f) ? 2000.0f : 1.0f;
            map.nits.emplace_back(nits, nits, nits);
        }
    return map;
}

TEST(PatchSky, AnOpenPlaneGetsPiTimesTheLuminance) {
    const auto made = test::prepare(SceneMaker().add("floor", quad({-3, 0, -3}, {0, 0, 6}, {6, 0, 0})).build());
    const SkySplit split = split_sky({1, 1, {Rgb(10, 20, 30)}, 0});
    for (const Rgb& h : light_of(*made, split, 64)) {
        EXPECT_NEAR(h.x, 10 * 3.14159265, 1e-3);
        EXPECT_NEAR(h.z, 30 * 3.14159265, 3e-3);
    }
}

TEST(PatchSky, ASmallBrightDiskKeepsItsShadow) {
    const auto made = floor_under_plate();
    const SkyMap map = sunny();
    const Sky sky(map);
    const SkySplit split = split_sky(map);
    ASSERT_FALSE(split.bright.empty());
    const auto split_light = light_of(*made, split, 1024);
    double error = 0, total = 0;
    for (PatchNumber p = 0; p < made->patches.count(); ++p) {
        const double truth = truth_of(*made, sky, p);
        error += std::abs(static_cast<double>(split_light[p].x) - truth);
        total += truth;
    }
    std::printf("mean error of patches %.2f %% of their mean light\n", 100 * error / total);
    EXPECT_LT(error / total, 0.03);
}

/// What the split is worth: bins that hold the disk too put its shadow elsewhere.
TEST(PatchSky, WithoutTheSplitTheShadowIsSmeared) {
    const auto made = floor_under_plate();
    const SkyMap map = sunny();
    const Sky sky(map);
    const SkySplit split = split_sky(map);
    std::vector<Rgb> whole_bins(split.bins);
    {
        std::vector<double> light(whole_bins.size()), solid(whole_bins.size());
        constexpr int columns = 1024;
        for (int y = 0; y < columns / 2; ++y)
            for (int x = 0; x < columns; ++x) {
                const double height = 1 - 2 * (y + 0.5) / (columns / 2),
                             along = 2 * 3.14159265358979 * (x + 0.5) / columns;
                const double ring = std::sqrt(1 - height * height);
                const Vec3f d(static_cast<float>(ring * std::cos(along)), static_cast<float>(height),
                              static_cast<float>(ring * std::sin(along)));
                light[sky_bin(d)] += static_cast<double>(sky.radiance(d).x);
                solid[sky_bin(d)] += 1;
            }
        for (std::size_t k = 0; k < light.size(); ++k) whole_bins[k] = Rgb(static_cast<float>(light[k] / solid[k]));
    }
    const auto smeared = light_of(*made, {whole_bins, {}}, 1024), apart = light_of(*made, split, 1024);
    double with = 0, without = 0, total = 0;
    for (PatchNumber p = 0; p < made->patches.count(); ++p) {
        const double truth = truth_of(*made, sky, p);
        with += std::abs(static_cast<double>(apart[p].x) - truth);
        without += std::abs(static_cast<double>(smeared[p].x) - truth);
        total += truth;
    }
    std::printf("mean error %.2f %% with the disk apart, %.2f %% with it in its bin\n", 100 * with / total,
                100 * without / total);
    EXPECT_LT(3 * with, without);
}

TEST(PatchSky, DoesNotDependOnNumbersOrThreads) {
    const auto made = floor_under_plate();
    const auto count = static_cast<PatchNumber>(made->patches.count());
    const auto whole = count_sky_rays(made->scene, made->atlas, made->patches, *made->tracer, 0, count, {128, 3});
    SkyCounts parts;
    for (PatchNumber begin = 0; begin < count; begin += 7) {
        const auto part = count_sky_rays(made->scene, made->atlas, made->patches, *made->tracer, begin,
                                         std::min(count, begin + 7), {128, 3});
        parts.bins_of_patch.insert(parts.bins_of_patch.end(), part.bins_of_patch.begin(), part.bins_of_patch.end());
        parts.bins.insert(parts.bins.end(), part.bins.begin(), part.bins.end());
        parts.counts.insert(parts.counts.end(), part.counts.begin(), part.counts.end());
    }
    EXPECT_EQ(whole, parts);
}

/// Texels of an open floor: cosine and aimed rays together have the mean of the whole sky, however uneven it is.
TEST(SkyGather, AnOpenFloorGetsTheIrradianceOfTheSky) {
    const auto made = test::prepare(SceneMaker().add("floor", quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0})).build());
    const EmitterSet emitters(made->scene, made->atlas, made->patches);
    const std::vector<Rgb> reflected(made->patches.count(), Rgb(0, 0, 0));
    for (const SkyMap& map : {SkyMap{1, 1, {Rgb(5, 5, 5)}, 0}, sunny()}) {
        const Sky sky(map);
        const RadiosityDetail radiosity({reflected.begin(), reflected.end()});
        const LightGuides guides;
        const GatherInput input{made->scene, made->atlas, made->texels, made->patches, *made->tracer, emitters, radiosity, guides, &sky};
        const auto light = gather_page(input, 0, {.rays = 256}, nullptr)->irradiance();
        const float expected = sky.irradiance({0, 1, 0}).x;
        double sum = 0;
        for (const Rgb& h : light) {
            EXPECT_NEAR(h.x, expected, 0.06f * expected);
            sum += static_cast<double>(h.x);
        }
        EXPECT_NEAR(sum / static_cast<double>(light.size()), expected, 0.004 * static_cast<double>(expected));
    }
}

/// A fan of triangles that are nearly one plane, close to the plane y = 0 where coordinates have hardly any rounding: no
/// ray may start behind the neighbour.
TEST(SkyGather, TrianglesThatAreNearlyOnePlaneAreNotDarkWhereTheyMeet) {
    for (const float height : {2e-5f, 5e-6f, 1.5e-6f, 5e-7f, 1e-7f}) {
        test::MadeMesh fan;
        fan.positions.emplace_back(0.1f, 0.0f, -0.23f);
        constexpr std::uint32_t rim = 14;
        for (std::uint32_t k = 0; k <= rim; ++k) {
            const double angle = 3.14159265358979 * k / rim;
            fan.positions.emplace_back(static_cast<float>(0.25 * std::cos(angle)), k % 2 ? height : 0.0f, static_cast<float>(0.25 * std::sin(angle)));
        }
        for (std::uint32_t k = 1; k <= rim; ++k) fan.triangles.push_back({0, k + 1, k});
        const auto made = test::prepare(SceneMaker().add("fan", fan).build(), {.texels_per_metre = 200});
        const EmitterSet emitters(made->scene, made->atlas, made->patches);
        const SkyMap map{1, 1, {Rgb(1, 1, 1)}, 0};
        const Sky sky(map);
        const RadiosityDetail radiosity(std::vector<Rgb>(made->patches.count(), Rgb(0, 0, 0)));
        const LightGuides guides;
        const GatherInput input{made->scene, made->atlas, made->texels, made->patches, *made->tracer, emitters, radiosity, guides, &sky};
        const auto light = gather_page(input, 0, {.rays = 64}, nullptr)->irradiance();
        ASSERT_GT(light.size(), 1000u);
        for (const Rgb& h : light) ASSERT_NEAR(h.x, 3.14159f, 0.01f) << height;
    }
}

/// Where hits are close the path goes on by itself: the sky must reach it there too.
TEST(SkyGather, NearPathsSeeTheSky) {
    const auto made = floor_under_plate();
    const EmitterSet emitters(made->scene, made->atlas, made->patches);
    const SkyMap map{1, 1, {Rgb(1, 1, 1)}, 0};
    const Sky sky(map);
    const auto gathered = [&](float near_m, std::span<const Rgb> reflected) {
        const RadiosityDetail radiosity({reflected.begin(), reflected.end()});
        const LightGuides guides;
        const GatherInput input{made->scene, made->atlas, made->texels, made->patches, *made->tracer, emitters, radiosity, guides, &sky};
        double sum = 0, area = 0;
        const auto light = gather_page(input, 0, {.rays = 256, .near_m = near_m}, nullptr)->irradiance();
        for (const Rgb& h : light) sum += static_cast<double>(h.x), area += 1;
        return sum / area;
    };
    // Paths that always go on need no solution of the patches: two bounces of a white sky brighten, and stay below it.
    const std::vector<Rgb> dark(made->patches.count(), Rgb(0, 0, 0));
    const double direct = gathered(0, dark), all = gathered(100, dark);
    EXPECT_GT(all, 1.02 * direct);
    EXPECT_LT(all, 3.1416);
}

}  // namespace
}  // namespace luxel
