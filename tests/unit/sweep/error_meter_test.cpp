// Figures of error against pages whose errors are known in closed form.
#include "baker/sweep/error_meter.h"

#include <gtest/gtest.h>

#include <cmath>

#include "baker/core/sobol.h"
#include "formats/base/error.h"

namespace luxel {
namespace {

PageLight page_of(std::uint32_t width, std::uint32_t height, const std::vector<std::array<float, 3>>& lux) { return {width, height, lux}; }

std::array<float, 3> grey(float lux) { return {lux, lux, lux}; }

MeasuredPage measured(PageLight light, std::vector<float> area_m2, std::vector<float> error = {}) { return {std::move(light), std::move(area_m2), std::move(error)}; }

ErrorFigures figures_of(const MeasuredPage& page, const ReferencePage& reference) {
    MeanLight mean;
    mean.add(reference, page.area_m2);
    ErrorMeter meter(mean.lux());
    meter.add(page, reference);
    return meter.figures();
}

TEST(ErrorMeter, WeighsByAreaAndSkipsWhatHasNoLight) {
    // Areas 1, 3, 0, 4 m2; reference 2, 2, 7, 1 lux; differences +1, -1, (anything), 0.
    const MeasuredPage page = measured(page_of(2, 2, {grey(3), grey(1), grey(1000), grey(1)}), {1, 3, 0, 4}, {0.5f, 0.5f, 9, 0.5f});
    const ErrorFigures f = figures_of(page, {page_of(2, 2, {grey(2), grey(2), grey(7), grey(1)}), {}});
    const double mean = (2 + 6 + 4) / 8.0;
    EXPECT_EQ(f.texels, 3u);
    EXPECT_DOUBLE_EQ(f.area_m2, 8);
    EXPECT_NEAR(f.mean_lux, mean, 1e-12);
    EXPECT_NEAR(f.relative_rmse, std::sqrt(4 / 8.0) / mean, 1e-12);
    EXPECT_NEAR(f.bias, (1 - 3) / 12.0, 1e-12);
    EXPECT_NEAR(f.median, 0, 1e-12) << "half of the area is right";
    EXPECT_NEAR(f.p95, 0.5, 1e-6);
    EXPECT_NEAR(f.worst.error, 0.5, 1e-12);
    EXPECT_EQ(f.worst.x, 0u);
    EXPECT_EQ(f.worst.y, 0u);
    EXPECT_NEAR(f.worst.lux, 3, 1e-6);
    EXPECT_NEAR(f.worst.reference_lux, 2, 1e-6);
    // Half of each texel's light: sqrt((1 * 9 + 3 * 1 + 4 * 1) / 4 / 8) over the mean light of the bake, 10 / 8.
    EXPECT_NEAR(f.predicted, std::sqrt(16 / 4.0 / 8) / (10 / 8.0), 1e-6);
    EXPECT_EQ(f.noise, 0);
    EXPECT_FALSE(f.is_below_noise);
}

TEST(ErrorMeter, ChannelsAreMeasuredAgainstTheirOwnMeans) {
    const MeasuredPage page = measured(page_of(2, 1, {{1.5f, 4, 0}, {2.5f, 4, 0}}), {1, 1});
    const ErrorFigures f = figures_of(page, {page_of(2, 1, {{1, 4, 0}, {3, 4, 0}}), {}});
    EXPECT_NEAR(f.channel_rmse[0], 0.5 / 2, 1e-6);
    EXPECT_EQ(f.channel_rmse[1], 0);
    EXPECT_EQ(f.channel_rmse[2], 0) << "there is no blue light";
    EXPECT_NEAR(f.relative_rmse, 0.2126 * 0.5 / (0.2126 * 2 + 0.7152 * 4), 1e-6);
    EXPECT_EQ(f.predicted, -1) << "the bake has no layer of errors";
}

TEST(ErrorMeter, DarkTexelsAreHeldAgainstAPartOfTheMean) {
    // Mean 50; the second texel of 0 lux is wrong by 0.25, half of 1 % of the mean.
    const ErrorFigures f = figures_of(measured(page_of(2, 1, {grey(100), grey(0.25f)}), {1, 1}), {page_of(2, 1, {grey(100), grey(0)}), {}});
    EXPECT_NEAR(f.worst.error, 0.5, 1e-6);
    EXPECT_EQ(f.worst.x, 1u);
}

/// Bake and reference scatter around the same truth: what is found is the noise of the bake alone.
TEST(ErrorMeter, NoiseOfTheReferenceIsTakenOut) {
    constexpr std::uint32_t side = 200;
    constexpr float truth = 10, bake_noise = 0.4f, reference_noise = 0.8f;
    const auto noisy = [&](float noise, std::uint64_t seed) {
        std::vector<std::array<float, 3>> lux;
        for (std::uint32_t k = 0; k < side * side; ++k) {
            // Uniform with a standard deviation of `noise`.
            const double u = static_cast<double>(mix(seed, k) >> 11) * 0x1p-53;
            lux.push_back(grey(truth + noise * static_cast<float>((u - 0.5) * std::sqrt(12.0))));
        }
        return page_of(side, side, lux);
    };
    const MeasuredPage page = measured(noisy(bake_noise, 1), std::vector<float>(side * side, 0.01f));
    const ErrorFigures f = figures_of(page, {noisy(reference_noise, 2), noisy(reference_noise, 3)});
    // The mean square is known to about sqrt(2 / n) of the sum of both variances.
    const double expected = bake_noise * bake_noise, mean_variance = reference_noise * reference_noise / 2;
    const double uncertainty = 5 * (expected + 2 * mean_variance) * std::sqrt(2.0 / (side * side));
    EXPECT_NEAR(std::pow(f.relative_rmse * f.mean_lux, 2), expected, uncertainty);
    EXPECT_NEAR(std::pow(f.noise * f.mean_lux, 2), mean_variance, uncertainty);
    EXPECT_TRUE(f.is_below_noise) << "0.16 against 0.32";
    EXPECT_EQ(figures_of(measured(page_of(1, 1, {grey(5)}), {1}), {page_of(1, 1, {grey(4)}), page_of(1, 1, {grey(6)})}).relative_rmse, 0) << "never the root of less than nothing";
}

TEST(ErrorMeter, PagesAddUp) {
    MeanLight mean;
    const MeasuredPage first = measured(page_of(1, 1, {grey(2)}), {1}), second = measured(page_of(2, 1, {grey(4), grey(8)}), {1, 2});
    const ReferencePage one{page_of(1, 1, {grey(1)}), {}}, two{page_of(2, 1, {grey(4), grey(4)}), {}};
    mean.add(one, first.area_m2);
    mean.add(two, second.area_m2);
    EXPECT_NEAR(mean.lux(), 13 / 4.0, 1e-6);
    ErrorMeter meter(mean.lux());
    meter.add(first, one);
    meter.add(second, two);
    const ErrorFigures f = meter.figures();
    EXPECT_NEAR(f.relative_rmse, std::sqrt((1 + 2 * 16) / 4.0) / (13 / 4.0), 1e-6);
    EXPECT_NEAR(f.bias, 9 / 13.0, 1e-6);
    ASSERT_EQ(meter.maps().size(), 2u);
    EXPECT_EQ(meter.maps()[1].error, (std::vector<float>{0, 1}));
}

TEST(ErrorMeter, MapsAreCoarseAndKnowWhereNothingIs) {
    constexpr std::uint32_t side = 2 * map_side;
    std::vector<std::array<float, 3>> lux(side * side, grey(1)), truth(side * side, grey(1));
    std::vector<float> area(side * side, 1);
    for (std::uint32_t k : {0u, 1u, side, side + 1}) area[k] = 0;      // the first cell is empty
    lux[2] = grey(1.5f);                                               // one of four texels of the second
    ErrorMeter meter(1);
    meter.add(measured(page_of(side, side, lux), area), {page_of(side, side, truth), {}});
    const ErrorMap& map = meter.maps()[0];
    EXPECT_EQ(map.width, map_side);
    EXPECT_EQ(map.height, map_side);
    EXPECT_EQ(map.error[0], -1);
    EXPECT_NEAR(map.error[1], 0.25, 1e-6);
    EXPECT_EQ(map.error[2], 0);
}

TEST(ErrorMeter, MapsShowThePartOfThePageThatIsUsed) {
    constexpr std::uint32_t side = 1024;
    std::vector<float> area(side * side, 0);
    std::vector<std::array<float, 3>> lux(side * side, grey(1)), truth(side * side, grey(1));
    for (std::uint32_t y = 10; y < 20; ++y)
        for (std::uint32_t x = 500; x < 540; ++x) area[y * side + x] = 1;
    lux[19 * side + 539] = grey(3);
    ErrorMeter meter(1);
    meter.add(measured(page_of(side, side, lux), area), {page_of(side, side, truth), {}});
    const ErrorMap& map = meter.maps()[0];
    ASSERT_EQ(map.width, 40u);
    ASSERT_EQ(map.height, 10u);
    EXPECT_EQ(map.error.front(), 0);
    EXPECT_EQ(map.error.back(), 2);
    meter.add(measured(page_of(1, 1, {grey(1)}), {0}), {page_of(1, 1, {grey(1)}), {}});
    EXPECT_TRUE(meter.maps()[1].error.empty());
}

TEST(ErrorMeter, RefusesWhatDoesNotFit) {
    ErrorMeter meter(1);
    const MeasuredPage page = measured(page_of(2, 1, {grey(1), grey(1)}), {1, 1});
    EXPECT_THROW(meter.add(page, {page_of(1, 2, {grey(1), grey(1)}), {}}), Error);
    EXPECT_THROW(meter.add(page, {page_of(2, 1, {grey(1), grey(1)}), page_of(1, 1, {grey(1)})}), Error);
    EXPECT_THROW(meter.add(measured(page_of(1, 1, {grey(NAN)}), {1}), {page_of(1, 1, {grey(1)}), {}}), Error);
    meter.add(measured(page_of(1, 1, {grey(NAN)}), {0}), {page_of(1, 1, {grey(1)}), {}});
}

}  // namespace
}  // namespace luxel
