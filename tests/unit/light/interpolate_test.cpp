/// Drafts: each method reproduces what it should, and never reads across a chart's border or through a wall.
#include "baker/light/interpolate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "baker/core/parallel.h"
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

/// Positive everywhere that a kernel looks at, and exact in float.
Rgb linear_field(float x, float y) { return {100 + 2 * x, 90 + 3 * y, 200 - x + 0.5f * y}; }

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

TEST(Interpolate, ALinearFieldStaysLinear) {
    const auto made = test::prepare(SceneMaker().add("floor", quad({0, 0, 0}, {0, 0, 5}, {4, 0, 0})).build(),
                                    {.texels_per_metre = 8, .patch_texels = cell});
    ASSERT_EQ(made->atlas.charts.size(), 1u);
    const Chart& chart = made->atlas.charts[0];
    for (const Interpolation how : all_interpolations) {
        if (how == Interpolation::constant) continue;
        // Kernels continue the slope up to the border; the means at corners need patches all around.
        const std::uint32_t margin = how == Interpolation::corners ? cell : 0;
        const auto pages = interpolate(*made, values_of(*made, linear_field), how);
        std::size_t inside = 0;
        for_texels(*made, [&](std::uint32_t page, std::size_t k, const Texel& texel, PatchNumber) {
            const std::uint32_t at_x = texel.x - chart.x, at_y = texel.y - chart.y;
            const auto last = [](std::uint32_t size) { return (size + cell - 1) / cell * cell; };
            if (at_x < margin || at_y < margin || at_x + margin >= last(chart.width) ||
                at_y + margin >= last(chart.height))
                return;
            const Rgb expected = linear_field(static_cast<float>(at_x) + 0.5f, static_cast<float>(at_y) + 0.5f);
            EXPECT_NEAR((pages[page][k] - expected).length(), 0, 2e-7 * expected.length()) << interpolation_name(how);
            ++inside;
        });
        EXPECT_GT(inside, 700u);
    }
}

TEST(Interpolate, WhereThereIsNoSlopeValuesAreContinued) {
    // Two strips, each one cell wide: light changes along them only.
    const auto made = test::prepare(SceneMaker()
                                        .add("along x", quad({0, 0, 0}, {0, 0, 0.5f}, {4, 0, 0}))
                                        .add("along z", quad({0, 1, 0}, {0, 0, 4}, {0.5f, 0, 0}))
                                        .build(),
                                    {.texels_per_metre = 8, .patch_texels = cell});
    for (const Interpolation how : all_interpolations) {
        const auto pages = interpolate(*made, values_of(*made, linear_field), how);
        for_texels(*made, [&](std::uint32_t page, std::size_t k, const Texel& texel, PatchNumber) {
            const Chart& chart = made->atlas.charts[texel.chart];
            const bool is_wide = chart.width > chart.height;
            ASSERT_EQ(is_wide ? chart.height : chart.width, cell);
            const float along = static_cast<float>(is_wide ? texel.x - chart.x : texel.y - chart.y) + 0.5f;
            if (how == Interpolation::constant || (how == Interpolation::corners && (along < cell || along > 28)))
                return;
            const Rgb expected = is_wide ? linear_field(along, cell / 2.0f) : linear_field(cell / 2.0f, along);
            EXPECT_NEAR((pages[page][k] - expected).length(), 0, 2e-7 * expected.length()) << interpolation_name(how);
        });
    }
}

/// A room with a ball in it: charts with straight and with ragged borders, and cells that are cut.
std::unique_ptr<Prepared> room_with_ball() {
    return test::prepare(SceneMaker()
                             .add("walls", test::room({0, 0, 0}, {1.7f, 1.1f, 1.3f}))
                             .add("ball", test::moved(test::icosphere(2, 0.4f), {0.8f, 0.3f, 0.6f}))
                             .build(),
                         {.patch_texels = cell});
}

TEST(Interpolate, WeightsSumToOneEverywhere) {
    const auto made = room_with_ball();
    const Rgb light(0.7f, 123.456f, 1e30f);
    for (const Interpolation how : all_interpolations) {
        const auto pages = interpolate(*made, std::vector<Rgb>(made->patches.count(), light), how);
        for_texels(*made, [&](std::uint32_t page, std::size_t k, const Texel& texel, PatchNumber) {
            const Rgb expected = made->texels.pages[page].can_send(texel) ? light : Rgb(0, 0, 0);
            EXPECT_EQ(pages[page][k], expected) << interpolation_name(how);
        });
    }
}

TEST(Interpolate, NeverAcrossCharts) {
    const auto made = room_with_ball();
    ASSERT_GT(made->atlas.charts.size(), 3u);
    for (std::uint32_t chosen = 0; chosen < made->atlas.charts.size(); ++chosen) {
        std::vector<Rgb> values;
        for (const Patch& patch : made->patches.patches)
            values.push_back(patch.chart == chosen ? Rgb(1, 2, 3) : Rgb(NAN, NAN, NAN));
        for (const Interpolation how : all_interpolations) {
            const auto pages = interpolate(*made, values, how);
            for_texels(*made, [&](std::uint32_t page, std::size_t k, const Texel& texel, PatchNumber) {
                if (texel.chart == chosen && made->texels.pages[page].can_send(texel)) {
                    EXPECT_EQ(pages[page][k], Rgb(1, 2, 3)) << interpolation_name(how);
                }
            });
        }
    }
}

/// Floors of 4 x 3 m with a wall across at x = 2.
struct WalledFloor {
    const char* name;
    test::MadeMesh wall;
};

std::vector<WalledFloor> walled_floors() {
    const auto sheet = [](float x) {
        test::MadeMesh mesh = quad({x, 0, 0}, {0, 1, 0}, {0, 0, 3});
        test::append(mesh, quad({x, 0, 0}, {0, 0, 3}, {0, 1, 0}));
        return mesh;
    };
    return {{"sheet between cells", sheet(2)},
            {"sheet through cells", sheet(2.3f)},
            {"solid wall, thinner than a cell", test::moved(test::box(0.2f, 1, 3), {2.1f, 0, 0})},
            {"solid wall, wider than a cell", test::moved(test::box(0.8f, 1, 3), {1.9f, 0, 0})}};
}

TEST(Interpolate, NoLightThroughAWall) {
    for (const auto& [name, wall] : walled_floors()) {
        SCOPED_TRACE(name);
        const auto made =
            test::prepare(SceneMaker().add("floor", quad({0, 0, 0}, {0, 0, 3}, {4, 0, 0})).add("wall", wall).build(),
                          {.texels_per_metre = 8, .patch_texels = cell});
        std::uint32_t floor_chart = none;
        std::vector<Rgb> values;
        std::size_t lit = 0, dark = 0;
        for (const Patch& patch : made->patches.patches) {
            const bool is_floor = made->atlas.charts[patch.chart].object == 0;
            if (is_floor) floor_chart = patch.chart;
            const bool is_lit = patch.center.x + static_cast<float>(made->scene.origin.x) > 2.2f;
            values.push_back(is_lit ? Rgb(1e20f, 1e20f, 1e20f) : Rgb(1, 1, 1));
            lit += is_floor && is_lit;
            dark += is_floor && !is_lit;
        }
        ASSERT_GT(lit, 15u);
        ASSERT_GT(dark, 15u);
        for (const Interpolation how : all_interpolations) {
            const auto pages = interpolate(*made, values, how);
            for_texels(*made, [&](std::uint32_t page, std::size_t k, const Texel& texel, PatchNumber patch) {
                if (texel.chart == floor_chart && made->texels.pages[page].can_send(texel)) {
                    EXPECT_EQ(pages[page][k], values[patch])
                        << interpolation_name(how) << " at " << texel.x << " " << texel.y;
                }
            });
        }
    }
}

TEST(Interpolate, CornersAreTheMeansOfThePatchesThatShareThem) {
    const auto made = test::prepare(SceneMaker().add("floor", quad({0, 0, 0}, {0, 0, 1}, {1, 0, 0})).build(),
                                    {.texels_per_metre = 8, .patch_texels = cell});
    const Chart& chart = made->atlas.charts.at(0);
    ASSERT_EQ((chart.width + cell - 1) / cell, 2u);
    ASSERT_EQ((chart.height + cell - 1) / cell, 2u);
    const float a = 1, b = 20, c = 300, d = 4000;  // the patches from left to right and top to bottom
    const auto pages = interpolate(*made,
                                   values_of(*made,
                                             [&](float x, float y) {
                                                 const float value = y < cell ? (x < cell ? a : b) : (x < cell ? c : d);
                                                 return Rgb(value, 2 * value, 3 * value);
                                             }),
                                   Interpolation::corners);
    const float corner[3][3] = {
        {a, (a + b) / 2, b}, {(a + c) / 2, (a + b + c + d) / 4, (b + d) / 2}, {c, (c + d) / 2, d}};
    for_texels(*made, [&](std::uint32_t page, std::size_t k, const Texel& texel, PatchNumber) {
        const std::uint32_t x = texel.x - chart.x, y = texel.y - chart.y;
        const auto* top = corner[y / cell] + x / cell;
        const auto* bottom = corner[y / cell + 1] + x / cell;
        const float u = (static_cast<float>(x % cell) + 0.5f) / cell, v = (static_cast<float>(y % cell) + 0.5f) / cell;
        const float expected = (top[0] * (1 - u) + top[1] * u) * (1 - v) + (bottom[0] * (1 - u) + bottom[1] * u) * v;
        EXPECT_NEAR(pages[page][k].x, expected, 1e-5f * expected);
        EXPECT_NEAR(pages[page][k].z, 3 * expected, 3e-5f * expected);
    });
}

TEST(Interpolate, CubicsOnAStep) {
    constexpr std::uint32_t odd = 5;  // so that a texel lies in the middle of each cell
    const auto made = test::prepare(SceneMaker().add("floor", quad({0, 0, 0}, {0, 0, 5}, {5, 0, 0})).build(),
                                    {.texels_per_metre = 8, .patch_texels = odd});
    std::vector<Rgb> values;
    for (const Patch& patch : made->patches.patches)
        values.push_back(patch.center.x + static_cast<float>(made->scene.origin.x) < 2.5f ? Rgb(0, 0, 0)
                                                                                          : Rgb(1000, 1000, 1000));
    const Chart& chart = made->atlas.charts.at(0);
    float smooth_least = 1e9f, smooth_most = 0, sharp_least = 1e9f, sharp_most = 0;
    std::size_t middles = 0;
    const auto smooth =
        interpolate_page(made->atlas, made->texels, made->patches, values, 0, odd, Interpolation::cubic_bspline);
    const auto sharp =
        interpolate_page(made->atlas, made->texels, made->patches, values, 0, odd, Interpolation::catmull_rom);
    for_texels(*made, [&](std::uint32_t, std::size_t k, const Texel& texel, PatchNumber patch) {
        smooth_least = std::min(smooth_least, smooth[k].x), smooth_most = std::max(smooth_most, smooth[k].x);
        sharp_least = std::min(sharp_least, sharp[k].x), sharp_most = std::max(sharp_most, sharp[k].x);
        if ((texel.x - chart.x) % odd == odd / 2 && (texel.y - chart.y) % odd == odd / 2) {
            EXPECT_FLOAT_EQ(sharp[k].x, values[patch].x) << "Catmull-Rom goes through the values";
            ++middles;
        }
    });
    EXPECT_EQ(middles, made->patches.count());
    EXPECT_EQ(smooth_least, 0);
    EXPECT_EQ(smooth_most, 1000);
    EXPECT_EQ(sharp_least, 0) << "it undershoots, but light is not negative";
    EXPECT_GT(sharp_most, 1010);
    EXPECT_LT(sharp_most, 1150);
}

TEST(Interpolate, MeansStayBetweenTheValuesAndNothingIsNegative) {
    const auto made = test::prepare(SceneMaker().add("ball", test::icosphere(3, 1)).build(), {.patch_texels = cell});
    std::vector<Rgb> values;
    for (const Patch& patch : made->patches.patches) values.emplace_back(static_cast<float>(patch.id % 1000), 1, 0);
    for (const Interpolation how : all_interpolations) {
        const auto pages = interpolate(*made, values, how);
        const bool is_mean = how == Interpolation::constant || how == Interpolation::corners;
        for_texels(*made, [&](std::uint32_t page, std::size_t k, const Texel&, PatchNumber) {
            const Rgb& h = pages[page][k];
            EXPECT_GE(h.x, 0);
            EXPECT_LE(h.x, is_mean ? 1000 : 3000) << interpolation_name(how);
            EXPECT_EQ(h.y, 1);
            EXPECT_EQ(h.z, 0);
        });
    }
}

TEST(Interpolate, NothingOverflows) {
    const auto made = room_with_ball();
    constexpr float most = std::numeric_limits<float>::max();
    std::vector<Rgb> values;
    for (const Patch& patch : made->patches.patches) values.emplace_back(patch.id % 2 ? most : 0.0f, most, 1e-30f);
    for (const Interpolation how : all_interpolations)
        for (const auto& page : interpolate(*made, values, how))
            for (const Rgb& h : page) EXPECT_TRUE(std::isfinite(h.x) && std::isfinite(h.y) && std::isfinite(h.z));
}

TEST(Interpolate, TheSameForAnyNumberOfThreads) {
    const auto made = room_with_ball();
    std::vector<Rgb> values;
    for (const Patch& patch : made->patches.patches)
        values.emplace_back(static_cast<float>(patch.id % 1000), static_cast<float>(patch.id % 7), 1);
    for (const Interpolation how : all_interpolations) {
        std::vector<std::vector<std::vector<Rgb>>> found;
        for (const unsigned threads : {1u, 3u}) {
            const ThreadLimit limit(threads);
            found.push_back(interpolate(*made, values, how));
        }
        EXPECT_EQ(found[0], found[1]);
    }
}

TEST(Interpolate, Names) {
    for (const Interpolation how : all_interpolations) EXPECT_EQ(interpolation_of(interpolation_name(how)), how);
    EXPECT_FALSE(interpolation_of("cubic"));
    EXPECT_FALSE(interpolation_of(""));
}

}  // namespace
}  // namespace luxel
