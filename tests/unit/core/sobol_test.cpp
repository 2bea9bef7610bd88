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

/// How unevenly 4096 pairs of one dimension of `a` and one of `b` fill 16 x 16 boxes: chi squared, mean over all dimensions and seeds. Of
/// independent pairs, both sides stratified, it is 225.
template <typename First, typename Second>
double unevenness() {
    double sum = 0;
    constexpr std::uint64_t seeds = 16;
    for (std::uint64_t seed = 0; seed < seeds; ++seed) {
        const First a(mix(seed, 1));
        const Second b(mix(seed, 2));
        std::array<std::array<int, 256>, 16> boxes{};
        for (std::uint32_t i = 0; i < 4096; ++i) {
            const auto u = a.point(i), w = b.point(i);
            for (std::size_t d = 0; d < 16; ++d)
                ++boxes[d][static_cast<std::size_t>(u[d / 4] * 16) * 16 + static_cast<std::size_t>(w[d % 4] * 16)];
        }
        for (const auto& pair : boxes)
            for (const int count : pair) sum += (count - 16) * (count - 16) / 16.0;
    }
    return sum / (16 * seeds);
}

TEST(ShuffledSobol, FillsTheSquareTogetherWithAnother) {
    EXPECT_GT((unevenness<SobolSequence, SobolSequence>()), 900) << "in one order there would be no need for it";
    EXPECT_LT((unevenness<SobolSequence, ShuffledSobol>()), 260);
    EXPECT_LT((unevenness<ShuffledSobol, ShuffledSobol>()), 260);
}

TEST(ShuffledSobol, AlignedRunsAreNets) {
    const ShuffledSobol sequence(5);
    constexpr unsigned k = 6, count = 1u << k;
    for (std::uint32_t begin = 0; begin < 16 * count; begin += count)
        for (unsigned split = 0; split <= k; ++split) {
            std::array<int, count> boxes{};
            for (std::uint32_t i = begin; i < begin + count; ++i) {
                const auto u = sequence.point(i);
                const auto x = static_cast<unsigned>(u[0] * static_cast<float>(1u << split));
                const auto y = static_cast<unsigned>(u[1] * static_cast<float>(1u << (k - split)));
                ++boxes[(x << (k - split)) | y];
            }
            for (const int found : boxes) ASSERT_EQ(found, 1) << "begin " << begin << " split " << split;
        }
}

}  // namespace
}  // namespace luxel
