#include "baker/formfactors/direction_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>
#include <vector>

#include "baker/core/sobol.h"

namespace luxel {
namespace {

std::vector<std::uint16_t> order_of(const std::vector<float>& u, const std::vector<float>& v) {
    std::vector<std::uint16_t> order(u.size());
    order_by_direction(u, v, order);
    return order;
}

void expect_permutation(std::vector<std::uint16_t> order) {
    std::sort(order.begin(), order.end());
    for (std::size_t k = 0; k < order.size(); ++k) ASSERT_EQ(order[k], k);
}

TEST(DirectionOrder, VisitsAFullGridByStepsToANeighbour) {
    for (const int side : {1, 2, 4, 8, 16, 32}) {
        std::vector<float> u, v;
        for (int y = 0; y < side; ++y)
            for (int x = 0; x < side; ++x) {
                u.push_back((static_cast<float>(x) + 0.5f) / static_cast<float>(side));
                v.push_back((static_cast<float>(y) + 0.5f) / static_cast<float>(side));
            }
        const auto order = order_of(u, v);
        expect_permutation(order);
        for (std::size_t k = 1; k < order.size(); ++k) {
            const int a = order[k - 1], b = order[k];
            ASSERT_EQ(std::abs(a % side - b % side) + std::abs(a / side - b / side), 1) << side << ", step " << k;
        }
    }
}

TEST(DirectionOrder, OfEqualPointsTheLowerNumberComesFirst) {
    const std::vector<float> same(100, 0.3f);
    std::vector<std::uint16_t> expected(100);
    std::iota(expected.begin(), expected.end(), std::uint16_t{0});
    EXPECT_EQ(order_of(same, same), expected);
    EXPECT_TRUE(order_of({}, {}).empty());
}

/// Eight in a row of 512 points of the sequence that rays use span far less than eight at random.
TEST(DirectionOrder, PacketsAreCompact) {
    for (const std::size_t count : {64u, 100u, 512u, 1024u, 3000u}) {
        std::vector<float> u(count), v(count);
        const SobolSequence sequence(7);
        for (std::size_t k = 0; k < count; ++k) {
            const auto point = sequence.point(static_cast<std::uint32_t>(k));
            u[k] = point[2], v[k] = point[3];
        }
        u[0] = v[0] = 0x1.fffffep-1f;
        const auto order = order_of(u, v);
        expect_permutation(order);
        double sum = 0;
        for (std::size_t k = 8; k <= count; k += 8) {
            float low_u = 1, high_u = 0, low_v = 1, high_v = 0;
            for (std::size_t j = k - 8; j < k; ++j) {
                low_u = std::min(low_u, u[order[j]]), high_u = std::max(high_u, u[order[j]]);
                low_v = std::min(low_v, v[order[j]]), high_v = std::max(high_v, v[order[j]]);
            }
            sum += std::max(static_cast<double>(high_u - low_u), static_cast<double>(high_v - low_v));
        }
        const double mean = sum / static_cast<double>(count / 8);
        const double cells = std::min(static_cast<double>(count), 1024.0);
        EXPECT_LT(mean, 5.5 / std::sqrt(cells)) << count << " points: eight cells in a row are four by two";
    }
}

}  // namespace
}  // namespace luxel
