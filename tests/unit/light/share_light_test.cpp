/// Shared light: noise goes, light that bends stays, edges stay, nothing passes walls or chart borders, and the mean is true.
#include "baker/light/share_light.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "baker/core/parallel.h"
#include "tests/support/scenes.h"

namespace luxel {
namespace {

using test::Prepared;
using test::quad;
using test::SceneMaker;

constexpr double density = 16;

std::unique_ptr<Prepared> sheet() {
    return test::prepare(SceneMaker().add("sheet", quad({0, 0, 0}, {0, 0, 4}, {4, 0, 0})).build(), {.texels_per_metre = density});
}

/// Place of a texel on its chart.
Vec2f place(const Prepared& made, const Texel& texel) {
    const Chart& chart = made.atlas.charts[texel.chart];
    return {static_cast<float>(texel.x - chart.x), static_cast<float>(texel.y - chart.y)};
}

using Field = std::function<float(const Texel&)>;

/// The field with noise of relative size `noise` in each half; skewed: most values a little low, few far too high.
GatheredLight noisy(const Prepared& made, const Field& field, float noise, bool is_skewed = false) {
    std::mt19937 random(7);
    std::normal_distribution<float> normal;
    GatheredLight light;
    for (std::vector<Rgb>& half : light.halves)
        for (const Texel& texel : made.texels.pages[0].texels) {
            const float n = normal(random);
            const float deviation = is_skewed ? (n * n - 1) / std::sqrt(2.0f) : n;
            half.push_back(Rgb(1, 2, 0.5f) * (field(texel) * (1 + noise * deviation)));
        }
    return light;
}

struct Errors {
    double mean = 0, rms = 0, largest = 0;
};

Errors errors(const Prepared& made, const SharedLight& shared, const Field& field, const std::function<bool(const Texel&)>& counts = {}) {
    Errors found;
    double count = 0, sum = 0;
    const auto& texels = made.texels.pages[0].texels;
    for (std::size_t k = 0; k < texels.size(); ++k) {
        if (counts && !counts(texels[k])) continue;
        const auto expected = static_cast<double>(field(texels[k]));
        const double difference = static_cast<double>(shared.irradiance[k].x) - expected;
        found.mean += difference, found.rms += difference * difference, sum += expected, ++count;
        found.largest = std::max(found.largest, std::fabs(difference));
    }
    return {found.mean / sum, std::sqrt(found.rms / count) / (sum / count), found.largest / (sum / count)};
}

SharedLight share(const Prepared& made, const GatheredLight& light, std::uint32_t texels = 8) {
    return share_light(made.texels.pages[0], made.texels.page_size, light, texels);
}

TEST(ShareLight, EvenLightLosesItsNoise) {
    const auto made = sheet();
    const Field even = [](const Texel&) { return 10.0f; };
    const GatheredLight light = noisy(*made, even, 0.1f);
    const Errors before = errors(*made, share(*made, light, 0), even), after = errors(*made, share(*made, light), even);
    EXPECT_NEAR(before.rms, 0.1 / std::sqrt(2.0), 0.005);
    EXPECT_LT(after.rms, before.rms / 3);
}

/// Where chance alone ends a disc's growth, noise would be left as a dot on even surroundings.
TEST(ShareLight, FewDotsAreLeft) {
    const auto made = sheet();
    const Field even = [](const Texel&) { return 10.0f; };
    const SharedLight shared = share(*made, noisy(*made, even, 0.3f, true));
    const auto dots = std::count_if(shared.irradiance.begin(), shared.irradiance.end(), [](const Rgb& light) { return std::fabs(light.x - 10) > 1; });
    // A tenth of the light is half of what one texel is off: 8 % of them were further off if each had the disc that it would choose alone.
    EXPECT_LT(static_cast<double>(dots), 0.06 * static_cast<double>(shared.irradiance.size()));
}

TEST(ShareLight, TheMeanIsTrueForSkewedNoiseToo) {
    const auto made = sheet();
    for (const bool bends : {false, true}) {
        const Field field = [&](const Texel& texel) {
            const Vec2f at = place(*made, texel) / static_cast<float>(density) - Vec2f(2, 2);
            return bends ? 100 / std::pow(1 + at.length2() / 2, 2.0f) : 100.0f;  // under a lamp: a peak
        };
        for (const float noise : {0.02f, 0.2f}) {
            const GatheredLight light = noisy(*made, field, noise, true);
            double raw = 0, sum = 0;
            for (std::size_t k = 0; k < light.halves[0].size(); ++k) {
                raw += static_cast<double>(light.halves[0][k].x + light.halves[1][k].x) / 2;
                sum += static_cast<double>(field(made->texels.pages[0].texels[k]));
            }
            const Errors found = errors(*made, share(*made, light), field);
            // Skewed noise still leans a little on how noise is judged: by its square, an order below what one texel has.
            const auto size = static_cast<double>(noise);
            EXPECT_NEAR(found.mean, raw / sum - 1, 1e-3 + 0.2 * size * size) << bends << " " << noise;
            EXPECT_LT(found.rms, 0.4 * size) << bends << " " << noise;
        }
    }
}

TEST(ShareLight, WithoutNoiseNothingChanges) {
    const auto made = sheet();
    const Field field = [&](const Texel& texel) { return place(*made, texel).x > 20 ? 1.0f : 50.0f + place(*made, texel).y; };
    const GatheredLight light = noisy(*made, field, 0);
    EXPECT_LT(errors(*made, share(*made, light), field).largest, 1e-6);
}

TEST(ShareLight, EdgesStay) {
    const auto made = sheet();
    const Field step = [&](const Texel& texel) { return place(*made, texel).x >= 30 ? 10.0f : 1.0f; };
    const GatheredLight light = noisy(*made, step, 0.05f);
    const SharedLight shared = share(*made, light);
    const auto beside = [&](float from, float to) {
        return errors(*made, shared, step, [&](const Texel& t) { return place(*made, t).x >= from && place(*made, t).x < to; });
    };
    // On the dark side a tenth of the step would already be the whole value.
    EXPECT_LT(beside(28, 30).rms, 0.06);
    EXPECT_LT(std::fabs(beside(28, 30).mean), 0.02);
    EXPECT_LT(beside(30, 32).rms, 0.06);
    EXPECT_LT(beside(8, 20).rms, 0.02);
}

/// Noise that is loud on the bright side is not the dark side's.
TEST(ShareLight, LoudLightDoesNotLeakIntoTheDark) {
    const auto made = sheet();
    const Field step = [&](const Texel& texel) { return place(*made, texel).x >= 30 ? 100.0f : 1.0f; };
    const Errors dark = errors(*made, share(*made, noisy(*made, step, 0.4f)), step, [&](const Texel& t) { return place(*made, t).x >= 24 && place(*made, t).x < 30; });
    // Were all of them as noisy as the mean of those around, the dark would be six times as bright as it is.
    EXPECT_LT(std::fabs(dark.mean), 1.5);
    EXPECT_LT(dark.rms, 5);
}

/// A wall that stands on the floor parts what lies on its two sides, though the noise would hide the difference.
TEST(ShareLight, NothingPassesAWall) {
    const auto made = test::prepare(SceneMaker()
                                        .add("floor", quad({0, 0, 0}, {0, 0, 2}, {4, 0, 0}))
                                        .add("wall", quad({2, -0.5f, -0.5f}, {0, 2, 0}, {0, 0, 3}), {.double_sided = true})
                                        .build(),
                                    {.texels_per_metre = density});
    const PageTexels& page = made->texels.pages[0];
    // Texels from the wall on along the floor's longer side; nothing near the wall shines, on neither side.
    std::vector<int> side;
    for (const Texel& texel : page.texels) {
        const Chart& chart = made->atlas.charts[texel.chart];
        const bool lies = chart.width > chart.height;
        const int along = static_cast<int>(lies ? texel.x - chart.x : texel.y - chart.y);
        side.push_back(chart.object == 0 ? along - static_cast<int>(lies ? chart.width : chart.height) / 2 : 0);
    }
    GatheredLight light;
    for (std::vector<Rgb>& half : light.halves)
        for (std::size_t k = 0; k < side.size(); ++k) half.push_back(Rgb(1, 1, 1) * (side[k] < -2 ? 1e6f : 1.0f));
    // Noise so loud on both sides that no interval can tell them apart.
    for (std::size_t k = 0; k < side.size(); ++k)
        light.halves[k % 2][k] *= 3.0f, light.halves[1 - k % 2][k] *= 0.1f;
    const SharedLight shared = share(*made, light);
    std::size_t dark = 0;
    for (std::size_t k = 0; k < side.size(); ++k)
        if (side[k] > 1) {
            EXPECT_LT(shared.irradiance[k].x, 10) << k;
            ++dark;
        }
    EXPECT_GT(dark, 500u);
}

TEST(ShareLight, SaysWhatNoiseIsLeft) {
    const auto made = sheet();
    const Field even = [](const Texel&) { return 10.0f; };
    const GatheredLight light = noisy(*made, even, 0.1f);
    const SharedLight shared = share(*made, light);
    double said = 0, found = 0;
    for (std::size_t k = 0; k < shared.irradiance.size(); ++k) {
        const double error = static_cast<double>(luminance(shared.irradiance[k]) - luminance(Rgb(10, 20, 5)));
        found += error * error;
        said += std::pow(static_cast<double>(shared.standard_error[k]), 2);
    }
    EXPECT_NEAR(std::sqrt(said / found), 1, 0.35);
}

/// Powers of two: not one bit of a mantissa may differ.
TEST(ShareLight, BrightnessChangesNothingButTheScale) {
    const auto made = sheet();
    const Field bent = [&](const Texel& texel) { return 2 + std::sin(place(*made, texel).x * 0.7f); };
    const GatheredLight light = noisy(*made, bent, 0.05f);
    const SharedLight plain = share(*made, light);
    EXPECT_GT(*std::max_element(plain.bias.begin(), plain.bias.end()), 0.01f);
    for (const float scale : {0x1p100f, 0x1p-100f}) {
        GatheredLight scaled = light;
        for (std::vector<Rgb>& half : scaled.halves)
            for (Rgb& value : half) value *= scale;
        const SharedLight found = share(*made, scaled);
        for (std::size_t k = 0; k < plain.irradiance.size(); ++k) {
            ASSERT_EQ(found.irradiance[k] / scale, plain.irradiance[k]) << k;
            ASSERT_EQ(found.standard_error[k] / scale, plain.standard_error[k]) << k;
            ASSERT_EQ(found.bias[k] / scale, plain.bias[k]) << k;
        }
    }
}

TEST(ShareLight, SameForAnyThreads) {
    const auto made = sheet();
    const Field field = [&](const Texel& texel) { return 1 + place(*made, texel).x; };
    const GatheredLight light = noisy(*made, field, 0.3f, true);
    std::vector<std::vector<Rgb>> found;
    for (const unsigned threads : {1u, 2u}) {
        const ThreadLimit limit(threads);
        found.push_back(share(*made, light).irradiance);
    }
    EXPECT_EQ(found[0], found[1]);
}

}  // namespace
}  // namespace luxel
