// Hidden texels: from the nearest light of their own chart, whatever lies beside it on the page.
#include "baker/output/fill_hidden.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "formats/base/error.h"

namespace luxel {
namespace {

struct Page {
    std::uint32_t width, height;
    std::vector<Rgb> values;
    std::vector<std::uint8_t> mask;
    std::vector<std::uint32_t> charts;
    Page(std::uint32_t w, std::uint32_t h)
        : width(w), height(h), values(w * h, Rgb(-1, -1, -1)), mask(w * h, texel_empty), charts(w * h, none) {}
    [[nodiscard]] std::size_t index(std::uint32_t x, std::uint32_t y) const { return std::size_t{y} * width + x; }
    void cover(std::uint32_t x, std::uint32_t y, std::uint32_t chart, float value) {
        values[index(x, y)] = Rgb(value, 2 * value, 3 * value);
        mask[index(x, y)] = texel_covered;
        charts[index(x, y)] = chart;
    }
    void hide(std::uint32_t x, std::uint32_t y, std::uint32_t chart) {
        mask[index(x, y)] = texel_hidden;
        charts[index(x, y)] = chart;
    }
    [[nodiscard]] float at(std::uint32_t x, std::uint32_t y) const { return values[index(x, y)].x; }
    [[nodiscard]] int state(std::uint32_t x, std::uint32_t y) const { return mask[index(x, y)]; }
    void fill() { fill_hidden(values, mask, charts, width, height); }
};

TEST(FillHidden, FromWhatTheyTouchAndNothingElse) {
    Page page(8, 3);
    page.cover(0, 1, 0, 2.0f);
    for (std::uint32_t x = 1; x < 5; ++x) page.hide(x, 1, 0);
    page.hide(7, 1, 0);  // alone
    page.fill();
    for (std::uint32_t x = 1; x < 5; ++x) {
        EXPECT_EQ(page.state(x, 1), texel_filled);
        EXPECT_FLOAT_EQ(page.at(x, 1), 2.0f);
        EXPECT_FLOAT_EQ(page.values[page.index(x, 1)].z, 6.0f);
    }
    EXPECT_EQ(page.state(7, 1), texel_empty);
    EXPECT_EQ(page.state(0, 0), texel_empty);
    EXPECT_FLOAT_EQ(page.at(5, 1), -1.0f);
}

TEST(FillHidden, ATexelOfAnotherChartIsNoSource) {
    // Chart 0 ends in hidden texels; chart 1, much brighter, begins right beside them.
    Page page(6, 4);
    for (std::uint32_t y = 0; y < 4; ++y) {
        page.cover(0, y, 0, 1.0f);
        for (std::uint32_t x = 1; x < 4; ++x) page.hide(x, y, 0);
        page.cover(4, y, 1, 1000.0f);
        page.hide(5, y, 1);
    }
    page.fill();
    for (std::uint32_t y = 0; y < 4; ++y) {
        for (std::uint32_t x = 1; x < 4; ++x) EXPECT_FLOAT_EQ(page.at(x, y), 1.0f) << x;
        EXPECT_FLOAT_EQ(page.at(5, y), 1000.0f);
    }
}

TEST(FillHidden, AChartWithoutLightStaysEmptyBesideABrightOne) {
    Page page(4, 1);
    page.cover(0, 0, 0, 5.0f);
    page.hide(1, 0, 1);
    page.hide(2, 0, 1);
    page.fill();
    EXPECT_EQ(page.state(1, 0), texel_empty);
    EXPECT_EQ(page.state(2, 0), texel_empty);
    EXPECT_FLOAT_EQ(page.at(1, 0), -1.0f);
}

TEST(FillHidden, ByDistanceFromBothSidesOfAWall) {
    Page page(9, 1);
    page.cover(0, 0, 0, 1.0f);
    page.cover(8, 0, 0, 9.0f);
    for (std::uint32_t x = 1; x < 8; ++x) page.hide(x, 0, 0);
    page.fill();
    for (std::uint32_t x = 1; x < 4; ++x) EXPECT_FLOAT_EQ(page.at(x, 0), 1.0f);
    EXPECT_FLOAT_EQ(page.at(4, 0), 5.0f) << "as far from either";
    for (std::uint32_t x = 5; x < 8; ++x) EXPECT_FLOAT_EQ(page.at(x, 0), 9.0f);
}

TEST(FillHidden, StraightNeighboursBeforeThoseAcrossTheCorner) {
    Page page(3, 3);
    page.hide(1, 1, 0);
    page.cover(0, 0, 0, 100.0f);
    page.cover(1, 0, 0, 2.0f);
    page.fill();
    EXPECT_FLOAT_EQ(page.at(1, 1), 2.0f);
}

// A filled texel has the light of covered texels that are, as the crow flies, hardly farther than the nearest one.
TEST(FillHidden, TheSourceIsNearlyTheNearest) {
    std::mt19937 random(11);
    for (int round = 0; round < 30; ++round) {
        constexpr std::uint32_t side = 24;
        Page page(side, side);
        for (std::uint32_t y = 0; y < side; ++y)
            for (std::uint32_t x = 0; x < side; ++x) page.hide(x, y, 3);
        // Light encodes the place, so that what comes out says where it is from: a mean of sources has the mean
        // distance at most.
        std::vector<std::pair<std::uint32_t, std::uint32_t>> sources;
        for (int k = 0; k < 3; ++k) {
            const auto x = static_cast<std::uint32_t>(random() % side), y = static_cast<std::uint32_t>(random() % side);
            page.cover(x, y, 3, 0);
            page.values[page.index(x, y)] = Rgb(static_cast<float>(x), static_cast<float>(y), 1);
            sources.emplace_back(x, y);
        }
        const std::vector<std::uint8_t> before = page.mask;
        page.fill();
        for (std::uint32_t y = 0; y < side; ++y)
            for (std::uint32_t x = 0; x < side; ++x) {
                if (before[page.index(x, y)] == texel_covered) continue;
                ASSERT_EQ(page.state(x, y), texel_filled);
                double nearest = 1e9;
                for (const auto& [sx, sy] : sources)
                    nearest = std::min(nearest, std::hypot(double(sx) - x, double(sy) - y));
                const Rgb& from = page.values[page.index(x, y)];
                // Chamfer 5-7 is 0.99 to 1.08 times the true distance.
                EXPECT_LE(std::hypot(static_cast<double>(from.x) - x, static_cast<double>(from.y) - y),
                          1.09 * nearest + 1e-5);
            }
    }
}

TEST(FillHidden, WrongSizes) {
    Page page(3, 3);
    EXPECT_THROW(fill_hidden(page.values, page.mask, page.charts, 4, 3), Error);
    EXPECT_THROW(fill_hidden(page.values, page.mask, std::span(page.charts).first(8), 3, 3), Error);
}

}  // namespace
}  // namespace luxel
