/// The radiosity that a ray reads: the patch's where nothing differs, the texel's where something does, the same power always.
#include "baker/light/radiosity_detail.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/scenes.h"

namespace luxel {
namespace {

using test::Prepared;
using test::quad;
using test::SceneMaker;

std::unique_ptr<Prepared> sheet() {
    return test::prepare(SceneMaker().add("sheet", quad({0, 0, 0}, {0, 0, 1}, {1, 0, 0})).build(), {.texels_per_metre = 16});
}

/// Reads back what a ray at the middle of a texel gets.
Rgb at_texel(const Prepared& made, const RadiosityDetail& detail, const Texel& texel) {
    const Chart& chart = made.atlas.charts[texel.chart];
    SurfaceTexel at;
    at.chart = &chart;
    at.x = texel.x - chart.x, at.y = texel.y - chart.y;
    at.patch = &made.patches.page_patch[0][std::size_t{texel.y} * made.patches.page_size + texel.x];
    return detail.at(*at.patch, made.patches, at);
}

TEST(RadiosityDetail, EvenLightStaysExact) {
    const auto made = sheet();
    const std::vector<Rgb> radiosity(made->patches.count(), Rgb(5, 1e-30f, 1e30f));
    RadiosityDetail detail(radiosity);
    detail.add_page(made->texels, made->patches, 0, std::vector<Rgb>(made->texels.pages[0].texels.size(), Rgb(3, 7, 1e-20f)));
    detail.finish();
    for (const Texel& texel : made->texels.pages[0].texels) EXPECT_EQ(at_texel(*made, detail, texel), radiosity[0]);
}

TEST(RadiosityDetail, FollowsTextureAndLightAndKeepsThePower) {
    auto made = sheet();
    std::vector<Texel>& texels = made->texels.pages[0].texels;
    std::vector<Rgb> irradiance;
    for (std::size_t k = 0; k < texels.size(); ++k) {
        texels[k].reflectance = (texels[k].x + texels[k].y) % 2 ? Rgb(0.9f, 0.5f, 0) : Rgb(0.1f, 0.5f, 0.4f);
        irradiance.emplace_back(1.0f + static_cast<float>(texels[k].x) / 8, 2.0f, 100.0f);
    }
    std::vector<Rgb> radiosity;
    for (std::size_t p = 0; p < made->patches.count(); ++p) radiosity.emplace_back(1.0f + static_cast<float>(p), 4.0f, 0.5f);
    RadiosityDetail detail(radiosity);
    detail.add_page(made->texels, made->patches, 0, irradiance);
    detail.finish();
    std::vector<std::array<double, 3>> power(radiosity.size()), expected_sum(radiosity.size());
    for (std::size_t k = 0; k < texels.size(); ++k) {
        const PatchNumber p = made->patches.page_patch[0][std::size_t{texels[k].y} * made->patches.page_size + texels[k].x];
        for (int c = 0; c < 3; ++c) {
            const auto channel = static_cast<std::size_t>(c);
            power[p][channel] += static_cast<double>(texels[k].visible_m2 * at_texel(*made, detail, texels[k])[c]);
            expected_sum[p][channel] += static_cast<double>(texels[k].visible_m2 * texels[k].reflectance[c] * irradiance[k][c]);
        }
    }
    for (std::size_t p = 0; p < radiosity.size(); ++p)
        for (int c = 0; c < 3; ++c) {
            const auto channel = static_cast<std::size_t>(c);
            const auto whole = static_cast<double>(radiosity[p][c] * made->patches.patches[p].area_m2);
            EXPECT_NEAR(power[p][channel], whole, 1e-5 * whole) << p << " " << c;
            for (std::size_t k = 0; k < texels.size(); ++k) {
                if (made->patches.page_patch[0][std::size_t{texels[k].y} * made->patches.page_size + texels[k].x] != p) continue;
                const double expected = whole * static_cast<double>(texels[k].reflectance[c] * irradiance[k][c]) / expected_sum[p][channel];
                // Factors come in steps of half a per cent.
                EXPECT_NEAR(at_texel(*made, detail, texels[k])[c], expected, 0.006 * expected);
            }
        }
}

TEST(RadiosityDetail, TakesWhatTexelsHaveGathered) {
    auto made = sheet();
    std::vector<Texel>& texels = made->texels.pages[0].texels;
    std::vector<Rgb> irradiance;
    for (Texel& texel : texels) {
        texel.reflectance = Rgb(0.5f, 0.25f, 0.1f);
        irradiance.emplace_back(3.0f + static_cast<float>(texel.x), texel.x % 3 ? 2.0f : 0.0f, 10.0f);
    }
    RadiosityDetail detail(std::vector<Rgb>(made->patches.count(), Rgb(100, 100, 100)), PatchMean::texels);
    detail.add_page(made->texels, made->patches, 0, irradiance);
    detail.finish();
    for (std::size_t k = 0; k < texels.size(); ++k)
        for (int c = 0; c < 3; ++c) {
            const float expected = texels[k].reflectance[c] * irradiance[k][c];
            EXPECT_NEAR(at_texel(*made, detail, texels[k])[c], expected, 0.01f * expected) << "whatever was solved";
        }
}

TEST(RadiosityDetail, WithoutPagesEveryTexelIsAsItsPatch) {
    const auto made = sheet();
    std::vector<Rgb> radiosity;
    for (std::size_t p = 0; p < made->patches.count(); ++p) radiosity.emplace_back(static_cast<float>(p), 1.0f, 2.0f);
    const RadiosityDetail detail(radiosity);
    for (const Texel& texel : made->texels.pages[0].texels) {
        const PatchNumber p = made->patches.page_patch[0][std::size_t{texel.y} * made->patches.page_size + texel.x];
        EXPECT_EQ(at_texel(*made, detail, texel), radiosity[p]);
    }
}

}  // namespace
}  // namespace luxel
