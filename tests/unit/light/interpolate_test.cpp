/// Drafts: constant and linear reproduce what they should, and never read across a chart's border.
#include "baker/light/interpolate.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/scenes.h"

namespace luxel {
namespace {

using test::Prepared;
using test::quad;
using test::SceneMaker;

constexpr std::uint32_t cell = 4;

/// Calls body(page, index, texel, patch of the texel).
template <class Body>
void for_texels(const Prepared& made, Body&& body) {
    for (std::uint32_t page = 0; page < made.texels.pages.size(); ++page)
        for (std::size_t k = 0; k < made.texels.pages[page].texels.size(); ++k) {
            const Texel& texel = made.texels.pages[page].texels[k];
            body(page, k, texel,
                 made.patches.page_patch[page][std::size_t{texel.y} * made.patches.page_size + texel.x]);
        }
}

std::vector<std::vector<Rgb>> interpolate(const Prepared& made, std::span<const Rgb> values, Interpolation how) {
    std::vector<std::vector<Rgb>> pages;
    for (std::uint32_t page = 0; page < made.texels.pages.size(); ++page) {
        pages.push_back(interpolate_page(made.atlas, made.texels, made.patches, values, page, cell, how));
        EXPECT_EQ(pages.back().size(), made.texels.pages[page].texels.size());
    }
    return pages;
}

/// A value per patch from the place of its cell on its chart.
std::vector<Rgb> values_of(const Prepared& made, const std::function<Rgb(float x, float y)>& value) {
    std::vector<Rgb> values(made.patches.count(), Rgb(NAN, NAN, NAN));
    for_texels(made, [&](std::uint32_t, std::size_t, const Texel& texel, PatchNumber patch) {
        const Chart& chart = made.atlas.charts[texel.chart];
        const auto center = [](std::uint32_t at) {
            return (static_cast<float>(at / cell) + 0.5f) * static_cast<float>(cell);
        };
        values[patch] = value(center(texel.x - chart.x), center(texel.y - chart.y));
    });
    return values;
}

Rgb linear_field(float x, float y) { return {1 + 2 * x, 3 * y, 100 - x + 0.5f * y}; }

TEST(Interpolate, ConstantIsThePatchItself) {
    const auto made =
        test::prepare(SceneMaker().add("walls", test::room({0, 0, 0}, {3, 2, 3})).build(), {.patch_texels = cell});
    std::vector<Rgb> values;
    for (PatchNumber p = 0; p < made->patches.count(); ++p) values.emplace_back(static_cast<float>(p), 1, 2);
    const auto pages = interpolate(*made, values, Interpolation::constant);
    for_texels(*made, [&](std::uint32_t page, std::size_t k, const Texel&, PatchNumber patch) {
        EXPECT_EQ(pages[page][k], values[patch]);
    });
}

TEST(Interpolate, LinearReproducesALinearField) {
    const auto made = test::prepare(SceneMaker().add("floor", quad({0, 0, 0}, {0, 0, 5}, {4, 0, 0})).build(),
                                    {.texels_per_metre = 8, .patch_texels = cell});
    ASSERT_EQ(made->atlas.charts.size(), 1u);
    const Chart& chart = made->atlas.charts[0];
    const auto pages = interpolate(*made, values_of(*made, linear_field), Interpolation::linear);
    std::size_t inside = 0;
    for_texels(*made, [&](std::uint32_t page, std::size_t k, const Texel& texel, PatchNumber) {
        const float x = static_cast<float>(texel.x - chart.x) + 0.5f, y = static_cast<float>(texel.y - chart.y) + 0.5f;
        // Between the centres of the outermost cells; beyond them a value is continued, not extrapolated.
        const float last_x = (static_cast<float>((chart.width - 1) / cell) + 0.5f) * cell;
        const float last_y = (static_cast<float>((chart.height - 1) / cell) + 0.5f) * cell;
        const float half = cell / 2.0f;
        const Rgb expected = linear_field(std::clamp(x, half, last_x), std::clamp(y, half, last_y));
        EXPECT_NEAR((pages[page][k] - expected).length(), 0, 1e-4 * expected.length());
        inside += x > half && x < last_x && y > half && y < last_y;
    });
    EXPECT_GT(inside, 500u);
}

TEST(Interpolate, NeverAcrossCharts) {
    const auto made = test::prepare(SceneMaker()
                                        .add("walls", test::room({0, 0, 0}, {1.7f, 1.1f, 1.3f}))
                                        .add("ball", test::moved(test::icosphere(2, 0.4f), {0.8f, 0.5f, 0.6f}))
                                        .build(),
                                    {.patch_texels = cell});
    ASSERT_GT(made->atlas.charts.size(), 3u);
    for (std::uint32_t chosen = 0; chosen < made->atlas.charts.size(); ++chosen) {
        std::vector<Rgb> values;
        for (const Patch& patch : made->patches.patches)
            values.push_back(patch.chart == chosen ? Rgb(1, 2, 3) : Rgb(NAN, NAN, NAN));
        for (const Interpolation how : {Interpolation::constant, Interpolation::linear}) {
            const auto pages = interpolate(*made, values, how);
            for_texels(*made, [&](std::uint32_t page, std::size_t k, const Texel& texel, PatchNumber) {
                if (texel.chart == chosen) {
                    EXPECT_NEAR((pages[page][k] - Rgb(1, 2, 3)).length(), 0, 1e-5);
                }
            });
        }
    }
}

TEST(Interpolate, LinearStaysBetweenItsNeighbours) {
    const auto made = test::prepare(SceneMaker().add("ball", test::icosphere(3, 1)).build(), {.patch_texels = cell});
    std::vector<Rgb> values;
    for (const Patch& patch : made->patches.patches) values.emplace_back(static_cast<float>(patch.id % 1000), 1, 0);
    const auto pages = interpolate(*made, values, Interpolation::linear);
    for_texels(*made, [&](std::uint32_t page, std::size_t k, const Texel&, PatchNumber) {
        const Rgb& h = pages[page][k];
        EXPECT_GE(h.x, 0);
        EXPECT_LE(h.x, 1000);
        EXPECT_NEAR(h.y, 1, 1e-5);
        EXPECT_EQ(h.z, 0);
    });
}

}  // namespace
}  // namespace luxel
