// Growing into the padding: means of neighbours, step by step, and never into what is covered.
#include "baker/output/dilate.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "formats/base/error.h"

namespace luxel {
namespace {

struct Page {
    std::uint32_t width, height;
    std::vector<Rgb> values;
    std::vector<std::uint8_t> mask;
    Page(std::uint32_t w, std::uint32_t h) : width(w), height(h), values(w * h, Rgb(-1, -1, -1)), mask(w * h, 0) {}
    void cover(std::uint32_t x, std::uint32_t y, float value) {
        values[y * width + x] = Rgb(value, 2 * value, 3 * value);
        mask[y * width + x] = texel_covered;
    }
    [[nodiscard]] float at(std::uint32_t x, std::uint32_t y) const { return values[y * width + x].x; }
    [[nodiscard]] int state(std::uint32_t x, std::uint32_t y) const { return mask[y * width + x]; }
    void grow(std::uint32_t steps) { dilate(values, mask, width, height, steps); }
};

TEST(Dilate, GrowsOneRingPerStep) {
    Page page(9, 9);
    page.cover(4, 4, 5.0f);
    page.grow(2);
    for (std::uint32_t y = 0; y < 9; ++y)
        for (std::uint32_t x = 0; x < 9; ++x) {
            const bool inside = x >= 2 && x <= 6 && y >= 2 && y <= 6;
            EXPECT_EQ(page.state(x, y), x == 4 && y == 4 ? texel_covered : inside ? texel_filled : texel_empty);
            EXPECT_FLOAT_EQ(page.at(x, y), inside ? 5.0f : -1.0f);
        }
    EXPECT_FLOAT_EQ(page.values[2 * 9 + 2].z, 15.0f);
}

TEST(Dilate, AveragesAndUsesOnlyWhatWasThereBeforeTheStep) {
    Page page(5, 1);
    page.cover(0, 0, 2.0f);
    page.cover(4, 0, 6.0f);
    page.grow(2);
    EXPECT_FLOAT_EQ(page.at(1, 0), 2.0f);
    EXPECT_FLOAT_EQ(page.at(3, 0), 6.0f);
    EXPECT_FLOAT_EQ(page.at(2, 0), 4.0f) << "second step, between both fronts";
}

TEST(Dilate, NeverTouchesCoveredTexels) {
    Page page(4, 4);
    for (std::uint32_t k = 0; k < 15; ++k) page.cover(k % 4, k / 4, static_cast<float>(k));
    page.grow(8);
    for (std::uint32_t k = 0; k < 15; ++k) EXPECT_EQ(page.at(k % 4, k / 4), static_cast<float>(k));
    EXPECT_FLOAT_EQ(page.at(3, 3), (10.0f + 11.0f + 14.0f) / 3.0f);
}

TEST(Dilate, EmptyPagesZeroStepsAndWrongSizes) {
    Page page(3, 3);
    page.grow(5);
    EXPECT_EQ(page.at(1, 1), -1.0f);
    page.cover(0, 0, 1.0f);
    page.grow(0);
    EXPECT_EQ(page.state(1, 1), texel_empty);
    std::vector<Rgb> none_at_all;
    std::vector<std::uint8_t> no_mask;
    dilate(none_at_all, no_mask, 0, 0, 3);
    EXPECT_THROW(dilate(page.values, page.mask, 4, 3, 1), Error);
}

// The front-following version against the plain definition, on random masks.
TEST(Dilate, EqualsTheDefinition) {
    std::mt19937 random(7);
    for (int round = 0; round < 20; ++round) {
        Page page(23, 17);
        for (int k = 0; k < 12; ++k) {
            const auto number = static_cast<std::uint32_t>(random());
            page.cover(number % 23, number / 23 % 17, static_cast<float>(number % 1000));
        }
        Page plain = page;
        for (int step = 0; step < 3; ++step) {
            const Page before = plain;
            for (int y = 0; y < 17; ++y)
                for (int x = 0; x < 23; ++x) {
                    const auto here = static_cast<std::size_t>(y * 23 + x);
                    if (before.mask[here]) continue;
                    Vec3d sum(0, 0, 0);
                    int count = 0;
                    for (int ny = std::max(0, y - 1); ny <= std::min(16, y + 1); ++ny)
                        for (int nx = std::max(0, x - 1); nx <= std::min(22, x + 1); ++nx) {
                            const auto near = static_cast<std::size_t>(ny * 23 + nx);
                            if (!before.mask[near]) continue;
                            sum += to_double(before.values[near]);
                            ++count;
                        }
                    if (!count) continue;
                    plain.values[here] = to_float(sum / count);
                    plain.mask[here] = texel_filled;
                }
        }
        page.grow(3);
        EXPECT_EQ(page.mask, plain.mask);
        EXPECT_EQ(page.values, plain.values);
    }
}

}  // namespace
}  // namespace luxel
