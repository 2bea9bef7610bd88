// Looks of surfaces: reflectance times light plus emission, over padding too; exposure by shares of the channels; the picture cut at white.
#include "baker/output/unlit_page.h"

#include <gtest/gtest.h>

#include <cmath>

#include "baker/output/dilate.h"
#include "baker/output/lightmap_encode.h"
#include "formats/image/image_file.h"
#include "tests/support/scenes.h"

namespace luxel {
namespace {

using test::quad;
using test::SceneMaker;

TEST(UnlitPage, IsReflectanceTimesLightPlusEmission) {
    const auto made = test::prepare(SceneMaker()
                                        .add("floor", quad({0, 0, 0}, {0, 0, 2}, {2, 0, 0}), {.reflectance = {0.75, 0.5, 0.25}})
                                        .add("sign", quad({0, 1, 0}, {0, 0, 1}, {1, 0, 0}), {.reflectance = {0.5, 0.5, 0.5}, .nits = {3, 2, 1}})
                                        .build(),
                                    {.texels_per_metre = 8, .patch_texels = 4});
    const std::uint32_t size = made->atlas.page_size;
    std::vector<Rgb> light(std::size_t{size} * size);
    for (std::size_t at = 0; at < light.size(); ++at) light[at] = Rgb(static_cast<float>(at % 7), 2, 4);
    const UnlitPage page = unlit_page(made->scene, made->atlas, made->texels.pages[0], light);
    EXPECT_TRUE(page.cover.empty()) << "all of it is opaque";
    std::size_t covered = 0, filled = 0;
    for (const Texel& texel : made->texels.pages[0].texels) {
        const std::size_t at = std::size_t{texel.y} * size + texel.x;
        const bool is_sign = made->atlas.charts[texel.chart].object == 1;
        const Rgb rho = is_sign ? Rgb(0.5f) : Rgb(0.75f, 0.5f, 0.25f);
        const Rgb exitance = is_sign ? made->scene.material_of(made->texels.pages[0].fragments[texel.first_fragment].triangle).emission : Rgb(0);
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(page.nits[at][c], (rho[c] * light[at][c] + exitance[c]) / M_PI, 1e-5);
        EXPECT_EQ(page.mask[at], texel_covered);
    }
    for (std::size_t at = 0; at < page.mask.size(); ++at) {
        covered += page.mask[at] == texel_covered;
        filled += page.mask[at] == texel_filled;
        if (page.mask[at] == texel_empty) {
            EXPECT_EQ(page.nits[at], Rgb(0, 0, 0));
        }
    }
    EXPECT_EQ(covered, made->texels.pages[0].texels.size());
    EXPECT_GT(filled, 0u);
    EXPECT_THROW((void)unlit_page(made->scene, made->atlas, made->texels.pages[0], std::span(light).first(5)), Error);
}

UnlitPage page_of(const std::vector<float>& values) {
    UnlitPage page;
    for (const float value : values) page.nits.emplace_back(value, value, value), page.mask.push_back(texel_covered);
    return page;
}

TEST(BrightnessCount, FindsSharesAsExactlyAsItSays) {
    for (const float scale : {1e-20f, 1.0f, 3e25f}) {
        std::vector<float> values;
        for (int k = 1; k <= 10000; ++k) values.push_back(scale * static_cast<float>(k));
        BrightnessCount count;
        count.add(page_of(values));
        for (const double share : {0.01, 0.5, 0.99, 1.0}) {
            const double exact = static_cast<double>(scale) * share * 10000;
            EXPECT_GE(count.value_of_share(share), exact * (1 - 1e-6));
            EXPECT_LE(count.value_of_share(share), exact * (1 + 1.0 / 128));
        }
        EXPECT_NEAR(count.share_above(static_cast<double>(scale) * 9900), 0.01, 0.008);
    }
}

TEST(BrightnessCount, DarkScenesAndWhatIsNotSurface) {
    BrightnessCount none, dark, mostly_dark;
    EXPECT_EQ(none.value_of_share(0.99), 1);
    EXPECT_EQ(none.share_above(0), 0);
    dark.add(page_of({0, 0, 0}));
    EXPECT_EQ(dark.value_of_share(0.99), 1);
    std::vector<float> values(1000, 0.0f);
    values[7] = 5;
    mostly_dark.add(page_of(values));
    EXPECT_NEAR(mostly_dark.value_of_share(0.5), 5, 0.05) << "light, not darkness, becomes white";
    UnlitPage page = page_of({100});
    page.mask[0] = texel_filled;
    dark.add(page);
    EXPECT_EQ(dark.value_of_share(1), 1) << "padding does not count";
}

TEST(UnlitPng, IsCutAtWhiteAndCarriesCover) {
    UnlitPage page = page_of({0, 1, 2, 4});
    const ImagePixels plain = decode_image(unlit_png(page, 2, 0.5, "luxel"), "png");
    EXPECT_EQ(plain.pixels[0][0], 0);
    EXPECT_NEAR(plain.pixels[1][0], 188 / 255.0, 1.1 / 255) << "half of white in sRGB";
    EXPECT_EQ(plain.pixels[2][0], 1);
    EXPECT_EQ(plain.pixels[3][0], 1);
    EXPECT_EQ(plain.pixels[0][3], 1);
    page.cover = {0, 0.25f, 0.5f, 1};
    const ImagePixels with_cover = decode_image(unlit_png(page, 2, 0.5, "luxel"), "png");
    for (std::size_t k = 0; k < 4; ++k) {
        EXPECT_EQ(with_cover.pixels[k][0], plain.pixels[k][0]);
        EXPECT_NEAR(with_cover.pixels[k][3], page.cover[k], 0.5 / 255 + 1e-6) << "and single precision";
    }
}

}  // namespace
}  // namespace luxel
