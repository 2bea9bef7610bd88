/// The sky by itself: where its pixels are, densities, means, and what patches keep of it.
#include "baker/light/sky.h"

#include <gtest/gtest.h>

#include <cmath>

#include "baker/core/sobol.h"
#include "baker/formfactors/sky_bins.h"
#include "baker/light/sky_cells.h"
#include "baker/light/sky_split.h"

namespace luxel {
namespace {

constexpr double pi_d = 3.14159265358979;

SkyMap even(float nits) { return {1, 1, {Rgb(nits, 2 * nits, 3 * nits)}, 0}; }

/// A blue gradient with a sun of a few pixels and a black ground.
SkyMap uneven(std::uint32_t width, float sun_nits, double turn = 0) {
    SkyMap map{width, width / 2, {}, turn};
    for (std::uint32_t y = 0; y < map.height; ++y)
        for (std::uint32_t x = 0; x < map.width; ++x) {
            const float up = 1 - 2 * (static_cast<float>(y) + 0.5f) / static_cast<float>(map.height);
            Rgb nits = up < 0 ? Rgb(0, 0, 0) : Rgb(1 + up, 2 + up, 4 + 0.5f * up);
            if (x == width / 3 && y == map.height / 4) nits = Rgb(sun_nits, sun_nits, 0.8f * sun_nits);
            map.nits.push_back(nits);
        }
    return map;
}

/// docs/lights.md: the middle is +X, a quarter to the right +Z, to the left -Z, the edges are -X, the upper rows are
/// up.
TEST(Sky, PixelsAreWhereThePageSays) {
    SkyMap map{8, 4, {}, 0};
    for (int k = 0; k < 32; ++k) map.nits.emplace_back(static_cast<float>(k), 0.0f, 0.0f);
    const auto at = [&](const Vec3f& d) { return static_cast<int>(Sky(map).radiance(d.normalized()).x); };
    EXPECT_EQ(at({1, 0.1f, 0.1f}), 1 * 8 + 4) << "right of the middle, a little up";
    EXPECT_EQ(at({1, 0.1f, -0.1f}), 1 * 8 + 3);
    EXPECT_EQ(at({0.1f, -0.1f, 1}), 2 * 8 + 5);
    EXPECT_EQ(at({-0.1f, -0.1f, 1}), 2 * 8 + 6);
    EXPECT_EQ(at({0.1f, 0.1f, -1}), 1 * 8 + 2);
    EXPECT_EQ(at({-1, 0.1f, 0.1f}), 1 * 8 + 7);
    EXPECT_EQ(at({-1, 0.1f, -0.1f}), 1 * 8 + 0);
    EXPECT_EQ(at({0.01f, 1, 0.001f}), 4) << "up";
    EXPECT_EQ(at({0.01f, -1, 0.001f}), 3 * 8 + 4) << "down";
    // A quarter turn counter-clockwise seen from above takes +X to -Z.
    map.turn = pi_d / 2;
    EXPECT_EQ(at({0.1f, 0.1f, -1}), 1 * 8 + 4);
    EXPECT_EQ(at({-0.1f, 0.1f, -1}), 1 * 8 + 3);
}

TEST(Sky, AnEvenSkyGivesPiTimesItsLuminance) {
    const SkyMap map = even(100);
    const Sky sky(map);
    EXPECT_FALSE(sky.is_uneven());
    for (const Vec3f& n : {Vec3f(0, 1, 0), Vec3f(0.6f, 0, 0.8f), Vec3f(0, -1, 0), Vec3f(1, 2, -3).normalized()}) {
        const Rgb e = sky.irradiance(n);
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(e[c], 100 * (c + 1) * pi_d, 0.02 * (c + 1));
    }
    EXPECT_NEAR(sky.density({0, 1, 0}), 1 / (4 * pi_d), 1e-6);
}

TEST(Sky, DensityIntegratesToOne) {
    for (const std::uint32_t width : {2u, 16u, 128u, 1000u})
        for (const float sun : {3.0f, 1e4f, 1e9f}) {
            const SkyMap map = uneven(width, sun, 1.234);
            const Sky sky(map);
            double sum = 0, solid = 0;
            for_each_sky_cell(map, 256, [&](const Vec3d& d, double solid_angle, std::size_t) {
                sum += static_cast<double>(sky.density(to_float(d))) * solid_angle;
                solid += solid_angle;
            });
            EXPECT_NEAR(solid, 4 * pi_d, 1e-6);
            EXPECT_NEAR(sum, 1, 2e-3) << width << " " << sun;
        }
}

TEST(Sky, SamplesHaveTheirDensityAndTheRightMean) {
    for (const float sun : {3.0f, 1e4f, 1e7f}) {
        const SkyMap map = uneven(64, sun, -0.7);
        const Sky sky(map);
        const Vec3f normal = Vec3f(0.3f, 0.9f, -0.2f).normalized();
        std::array<double, 3> sum{};
        const SobolSequence points(7);
        constexpr std::uint32_t count = 1 << 16;
        for (std::uint32_t k = 0; k < count; ++k) {
            const auto u = points.point(k);
            const Sky::Sample s = sky.sample(u[0], u[1]);
            ASSERT_NEAR(s.direction.length(), 1, 1e-5);
            ASSERT_EQ(s.density, sky.density(s.direction));
            if (!(s.density > 0)) continue;
            for (int c = 0; c < 3; ++c)
                sum[static_cast<std::size_t>(c)] +=
                    static_cast<double>(sky.radiance(s.direction)[c] * std::max(0.0f, s.direction.dot(normal)) /
                                        s.density) /
                    count;
        }
        const Rgb expected = sky.irradiance(normal);
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(sum[static_cast<std::size_t>(c)], expected[c], 3e-3 * static_cast<double>(expected[c])) << sun;
    }
}

TEST(Sky, UnevenMeansFewBrightDirections) {
    const SkyMap gentle = uneven(64, 3), sunny = uneven(64, 1e5f), dark{2, 1, {Rgb(0, 0, 0), Rgb(0, 0, 0)}, 0};
    EXPECT_TRUE(Sky(sunny).is_uneven());
    EXPECT_TRUE(Sky(dark).is_dark());
    EXPECT_FALSE(Sky(gentle).is_dark());
}

TEST(SkyBins, HaveEqualSolidAnglesWhereThePageSays) {
    std::vector<double> solid(sky_bin_count);
    const SkyMap map = even(1);
    for_each_sky_cell(map, 2048, [&](const Vec3d& d, double solid_angle, std::size_t) {
        const double longitude = std::atan2(d.z, d.x) + (d.z < 0 ? 2 * pi_d : 0);
        const auto band = static_cast<std::uint32_t>((1 - d.y) * 16),
                   part = static_cast<std::uint32_t>(longitude / pi_d * 16);
        solid[sky_bin(to_float(d))] += solid_angle;
        ASSERT_EQ(sky_bin(to_float(d)), band * 32 + part) << d.x << " " << d.y << " " << d.z;
    });
    for (const double s : solid) EXPECT_NEAR(s, 4 * pi_d / 1024, 0.04 * 4 * pi_d / 1024);
}

TEST(SkyBins, DirectionsLieInTheirBinAndAllOverIt) {
    for (std::uint32_t bin = 0; bin < sky_bin_count; ++bin) {
        Vec3f sum(0, 0, 0);
        for (const Vec3f& d : directions_in_sky_bin(static_cast<SkyBin>(bin))) {
            EXPECT_NEAR(d.length(), 1, 1e-6f);
            EXPECT_EQ(sky_bin(d), bin);
            sum += d;
        }
        EXPECT_EQ(sky_bin(sum.normalized()), bin);
    }
}

TEST(SkySplit, PartsAddUpAndTheSunIsTakenOut) {
    for (const float sun : {3.0f, 1e3f, 1e8f}) {
        const SkyMap map = uneven(128, sun, 0.4);
        const SkySplit split = split_sky(map);
        std::array<double, 3> whole{}, parts{};
        for_each_sky_cell(map, 256, [&](const Vec3d& d, double solid_angle, std::size_t pixel) {
            for (int c = 0; c < 3; ++c) {
                const auto k = static_cast<std::size_t>(c);
                whole[k] += solid_angle * static_cast<double>(map.nits[pixel][c]);
                parts[k] += solid_angle * static_cast<double>(split.bins[sky_bin(to_float(d))][c]);
                if (!split.bright.empty()) parts[k] += solid_angle * static_cast<double>(split.bright.nits[pixel][c]);
            }
        });
        for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(parts[c], whole[c], 5e-3 * whole[c]) << sun;
        if (sun < 10) continue;
        ASSERT_FALSE(split.bright.empty());
        for (const Rgb& bin : split.bins) EXPECT_LT(bin.x, 6) << "nothing of the sun is left in a bin";
    }
    EXPECT_TRUE(split_sky(even(5)).bright.empty());
}

}  // namespace
}  // namespace luxel
