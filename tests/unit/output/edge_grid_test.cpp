// The grid finds every pair that all-against-all finds, each once.
#include "baker/output/edge_grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

namespace luxel {
namespace {

using Pair = std::pair<std::uint32_t, std::uint32_t>;

std::set<Pair> pairs_of(const EdgeGrid& grid, std::uint32_t count) {
    std::set<Pair> pairs;
    for (std::uint32_t s = 0; s < count; ++s) {
        const auto near = grid.longer_near(s, 1u << 20);
        EXPECT_TRUE(std::is_sorted(near.begin(), near.end()));
        for (const std::uint32_t other : near)
            EXPECT_TRUE(pairs.insert(std::minmax(s, other)).second) << s << " " << other;
    }
    return pairs;
}

TEST(EdgeGrid, EqualsAllAgainstAll) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> place(-10, 10), size(-9, 3);
    std::vector<GridSegment> segments;
    for (int k = 0; k < 400; ++k) {
        const Vec3d from(place(random), place(random), place(random));
        const double length = std::exp2(size(random));
        segments.push_back({from, from + Vec3d(place(random), place(random), place(random)).normalized() * length});
        // Along an axis at a round coordinate, where planes between cells could part what is together.
        segments.push_back({Vec3d(std::round(from.x), 2, 4), Vec3d(std::round(from.x) + length, 2, 4)});
        segments.push_back({Vec3d(std::round(from.x), 2, 4 + 1e-9), Vec3d(std::round(from.x) - length, 2, 4 - 1e-9)});
    }
    constexpr double near_m = 1e-6;
    std::set<Pair> expected;
    for (std::uint32_t a = 0; a < segments.size(); ++a)
        for (std::uint32_t b = a + 1; b < segments.size(); ++b) {
            bool meet = true;
            for (int k = 0; k < 3; ++k)
                meet = meet &&
                       std::min(segments[a].from[k], segments[a].to[k]) - near_m <=
                           std::max(segments[b].from[k], segments[b].to[k]) + near_m &&
                       std::min(segments[b].from[k], segments[b].to[k]) - near_m <=
                           std::max(segments[a].from[k], segments[a].to[k]) + near_m;
            if (meet) expected.emplace(a, b);
        }
    ASSERT_GT(expected.size(), 1000u);
    EXPECT_EQ(pairs_of(EdgeGrid(segments, near_m), static_cast<std::uint32_t>(segments.size())), expected);
}

TEST(EdgeGrid, LooksAtNoMoreThanWanted) {
    const std::vector<GridSegment> same(1000, {{0, 0, 0}, {1, 0, 0}});
    const EdgeGrid grid(same, 1e-6);
    EXPECT_EQ(grid.longer_near(0, 1u << 20).size(), 999u);
    EXPECT_LE(grid.longer_near(0, 10).size(), 10u);
    EXPECT_EQ(grid.longer_near(0, 10).front(), 1u);
    EXPECT_TRUE(grid.longer_near(999, 10).empty());
}

TEST(EdgeGrid, Empty) { EXPECT_NO_THROW(EdgeGrid({}, 0)); }

}  // namespace
}  // namespace luxel
