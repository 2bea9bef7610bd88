// Codes of single texels: bounds in closed form over many decades, exact values kept, the choice of M the best there is.
#include "baker/output/texel_codes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace luxel {
namespace {

/// Colours whose channels are spread over `decades` below 1.
std::vector<TexelValues> colours(double decades, std::size_t count = 20000) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> uniform(0, 1);
    std::vector<TexelValues> values{{1, 1, 1}, {1, 0, 0}, {0, 0, 0}, {0.5, 0.25, 0.125}};
    while (values.size() < count) {
        const double size = std::pow(10.0, -decades * uniform(random));
        values.push_back({size * uniform(random), size * uniform(random), size * uniform(random)});
    }
    return values;
}

double largest_of(const TexelValues& values) { return *std::ranges::max_element(values); }

TEST(TexelCodes, RgbeErrsByAtMostAnEighthBitOfTheLargestChannel) {
    double worst = 0;
    for (const double scale : {1.0, 1e-30, 3e35})
        for (TexelValues values : colours(6)) {
            for (double& v : values) v *= scale;
            const TexelValues decoded = rgbe_values(rgbe_of(values));
            for (std::size_t c = 0; c < 3; ++c) {
                const double error = std::abs(decoded[c] - values[c]);
                ASSERT_LE(error, largest_of(values) / 256) << values[c];
                if (largest_of(values) > 0) worst = std::max(worst, error / largest_of(values));
            }
        }
    EXPECT_GT(worst, 0.9 / 256) << "the bound is reached";
}

TEST(TexelCodes, RgbeKnowsItsEnds) {
    EXPECT_EQ(rgbe_of({0, 0, 0}), (TexelBytes{0, 0, 0, 0}));
    EXPECT_EQ(rgbe_of({1, 0.5, 0.25}), (TexelBytes{128, 64, 32, 129}));
    EXPECT_EQ(rgbe_of({0.9999, 0, 0}), (TexelBytes{128, 0, 0, 129})) << "rounding up takes the next exponent";
    EXPECT_EQ(rgbe_of({1e-45, 0, 0}), (TexelBytes{0, 0, 0, 0}));
    EXPECT_EQ(rgbe_of({-1, 2, 0}), (TexelBytes{0, 128, 0, 130})) << "negative values become 0";
    EXPECT_EQ(rgbe_values({1, 2, 3, 0}), (TexelValues{0, 0, 0}));
}

TEST(TexelCodes, RgbmStaysWithinItsBoundOverSixDecades) {
    for (const TexelValues& shares : colours(6)) {
        const TexelValues decoded = rgbm_shares(rgbm_of(shares));
        for (std::size_t c = 0; c < 3; ++c)
            ASSERT_LE(std::abs(decoded[c] - shares[c]), (255 * largest_of(shares) + 1) / 130050 + 1e-15) << shares[c];
    }
    EXPECT_EQ(rgbm_of({0, 0, 0}), (TexelBytes{0, 0, 0, 255}));
    EXPECT_EQ(rgbm_of({1, 1, 1}), (TexelBytes{255, 255, 255, 255}));
}

TEST(TexelCodes, RgbmTakesTheBestMNearTheSmallest) {
    std::size_t choices = 0, better = 0;
    for (const TexelValues& shares : colours(2, 2000)) {
        const auto error_with = [&](int m) {
            double error = 0;
            for (const double share : shares) error = std::max(error, std::abs(std::round(share * 65025 / m) * m / 65025 - share));
            return error;
        };
        const TexelBytes bytes = rgbm_of(shares);
        if (largest_of(shares) == 0) continue;
        const int smallest = static_cast<int>(std::ceil(255 * largest_of(shares)));
        ASSERT_GE(bytes[3], smallest);
        ASSERT_LE(bytes[3], smallest + smallest / 16);
        for (int m = smallest; m <= std::min(255, smallest + smallest / 16); ++m) ASSERT_LE(error_with(bytes[3]), error_with(m) + 1e-15);
        choices += smallest >= 16 && smallest < 255;
        better += error_with(bytes[3]) < error_with(smallest);
    }
    EXPECT_GT(better, choices / 2) << "the choice matters where there is one";
}

TEST(TexelCodes, RgbmOfMxIsWhatItsReadersDecode) {
    for (int m = 0; m < 256; ++m) {
        const double power = std::pow(m / 255.0, 2.2);
        EXPECT_NEAR(rgbm_mx_shares({255, 51, 0, static_cast<std::uint8_t>(m)})[0], power, 1e-15) << m;
        EXPECT_NEAR(rgbm_mx_shares({255, 51, 0, static_cast<std::uint8_t>(m)})[1], power / 5, 1e-15) << m;
    }
    EXPECT_EQ(rgbm_mx_of({1, 1, 1}), (TexelBytes{255, 255, 255, 255}));
    EXPECT_EQ(rgbm_mx_of({0, 0, 0}), (TexelBytes{0, 0, 0, 0})) << "no neighbour of a dark texel may shine";
}

TEST(TexelCodes, RgbmOfMxStaysWithinItsBoundOverSixDecades) {
    double worst = 0;
    for (const TexelValues& shares : colours(6)) {
        const TexelBytes bytes = rgbm_mx_of(shares);
        const TexelValues decoded = rgbm_mx_shares(bytes);
        const double bound = std::pow(std::pow(largest_of(shares), 1 / 2.2) + 1 / 255.0, 2.2) / 510;
        for (std::size_t c = 0; c < 3; ++c) {
            const double error = std::abs(decoded[c] - shares[c]);
            ASSERT_LE(error, bound + 1e-15) << shares[c];
            worst = std::max(worst, error / bound);
        }
    }
    EXPECT_GT(worst, 0.9) << "the bound is reached";
}

TEST(TexelCodes, RgbmOfMxTakesTheBestMNearTheSmallest) {
    for (const TexelValues& shares : colours(2, 2000)) {
        if (largest_of(shares) == 0) continue;
        const auto error_of = [&](const TexelBytes& bytes) {
            double error = 0;
            for (std::size_t c = 0; c < 3; ++c) error = std::max(error, std::abs(rgbm_mx_shares(bytes)[c] - shares[c]));
            return error;
        };
        const TexelBytes found = rgbm_mx_of(shares);
        const int smallest = std::min(255, static_cast<int>(std::ceil(255 * std::pow(largest_of(shares), 1 / 2.2) - 1e-9)));
        ASSERT_GE(found[3], smallest);
        ASSERT_LE(found[3], smallest + smallest / 28);
        for (int m = smallest; m <= std::min(255, smallest + smallest / 28); ++m) {
            TexelBytes other{0, 0, 0, static_cast<std::uint8_t>(m)};
            for (std::size_t c = 0; c < 3; ++c) other[c] = static_cast<std::uint8_t>(std::min(255.0, std::round(255 * shares[c] / std::pow(m / 255.0, 2.2))));
            ASSERT_LE(error_of(found), error_of(other) + 1e-15);
        }
    }
}

TEST(TexelCodes, HalvesAreScaledOnlyWhereTheyMustBe) {
    EXPECT_EQ(half_intensity(std::vector<float>{0, 1, 60000}), 1);
    EXPECT_EQ(half_intensity(std::vector<float>{0, 0}), 1);
    for (const float largest : {65505.0f, 65536.0f, 1e30f, 1e-6f, 1e-38f}) {
        const double intensity = half_intensity(std::vector<float>{0.7f * largest, largest});
        int exponent = 0;
        EXPECT_EQ(std::frexp(intensity, &exponent), 0.5) << "a power of two";
        const double scaled = static_cast<double>(largest) / intensity;
        EXPECT_GE(scaled, 0x1p14);
        EXPECT_LT(scaled, 0x1p15);
    }
}

}  // namespace
}  // namespace luxel
