#include "baker/core/sobol.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace luxel {
namespace {

// A (0, k, 2)-net: every elementary box of area 2^-k holds exactly one of the first 2^k points.
TEST(Sobol, FirstTwoDimensionsAreANet) {
    for (const std::uint64_t seed : {1ull, 2ull, 99ull}) {
        const SobolSequence sequence(seed);
        constexpr unsigned k = 8;
        for (unsigned split = 0; split <= k; ++split) {
            std::vector<int> boxes(1u << k);
            for (std::uint32_t i = 0; i < (1u << k); ++i) {
                const auto u = sequence.point(i);
                const auto x = static_cast<unsigned>(u[0] * static_cast<float>(1u << split));
                const auto y = static_cast<unsigned>(u[1] * static_cast<float>(1u << (k - split)));
                ++boxes[(x << (k - split)) | y];
            }
            for (const int count : boxes) ASSERT_EQ(count, 1) << "split " << split << " seed " << seed;
        }
    }
}

TEST(Sobol, EveryDimensionIsStratifiedAndPointsStayBelowOne) {
    const SobolSequence sequence(5);
    std::vector<std::array<int, 4>> strata(1024);
    for (std::uint32_t i = 0; i < 1024; ++i) {
        const auto u = sequence.point(i);
        for (std::size_t d = 0; d < 4; ++d) {
            ASSERT_GE(u[d], 0.0f);
            ASSERT_LT(u[d], 1.0f);
            ++strata[static_cast<std::size_t>(u[d] * 1024)][d];
        }
    }
    for (const auto& stratum : strata)
        for (const int count : stratum) EXPECT_EQ(count, 1);
}

TEST(Sobol, IntegratesAProductFourTimesBetterThanRandomPointsWould) {
    // The mean of prod (0.5 + u_d) is 1; its standard deviation for N random points is 0.73 / sqrt(N).
    double squared_error = 0;
    constexpr int seeds = 64;
    for (std::uint64_t seed = 0; seed < seeds; ++seed) {
        const SobolSequence sequence(mix(seed));
        double sum = 0;
        for (std::uint32_t i = 0; i < 256; ++i) {
            const auto u = sequence.point(i);
            sum += (0.5 + static_cast<double>(u[0])) * (0.5 + static_cast<double>(u[1])) *
                   (0.5 + static_cast<double>(u[2])) * (0.5 + static_cast<double>(u[3]));
        }
        squared_error += (sum / 256 - 1) * (sum / 256 - 1);
    }
    EXPECT_LT(std::sqrt(squared_error / seeds), 0.73 / 16 / 4);
}

}  // namespace
}  // namespace luxel
