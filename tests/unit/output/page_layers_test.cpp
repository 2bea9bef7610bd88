// Layers of a page against surfaces that are known: a wall of one colour, a ball, a box on a floor; and their file.
#include "baker/output/page_layers.h"

#include <gtest/gtest.h>

#include <cmath>

#include "baker/output/fill_hidden.h"
#include "baker/patches/texel_surface.h"
#include "tests/support/exr_parts.h"
#include "tests/support/scenes.h"

namespace luxel {
namespace {

using test::Prepared;
using test::quad;
using test::SceneMaker;

/// A floor with a box that stands in it, so that some of the floor is hidden, and a ball.
std::unique_ptr<Prepared> made_scene() {
    return test::prepare(
        SceneMaker()
            .add("floor", quad({0, 0, 0}, {0, 0, 3}, {3, 0, 0}), {.reflectance = {0.75, 0.5, 0.25}})
            .add("block", test::moved(test::box(1, 1, 1), {1, -0.5f, 1}), {.reflectance = {0.125, 0.25, 1}})
            .add("ball", test::moved(test::icosphere(3, 0.4f), {0.5f, 1, 0.5f}))
            .build(),
        {.texels_per_metre = 8, .patch_texels = 4});
}

struct MadePage {
    std::unique_ptr<Prepared> made = made_scene();
    std::vector<std::uint8_t> mask;
    std::vector<std::uint32_t> charts;
    std::vector<TexelLight> light;

    MadePage() {
        const Atlas& atlas = made->atlas;
        const PageTexels& content = made->texels.pages.at(0);
        std::vector<Rgb> values(std::size_t{atlas.page_size} * atlas.page_size);
        mask.assign(values.size(), texel_empty);
        charts.assign(values.size(), none);
        for (const Texel& texel : content.texels) {
            charts[place(texel)] = texel.chart;
            mask[place(texel)] = content.can_send(texel) ? texel_covered : texel_hidden;
            TexelLight& of_texel = light.emplace_back();
            of_texel.direct = {static_cast<float>(light.size()), 2, 3};
            of_texel.indirect = {0.5f, static_cast<float>(light.size() % 10), 4};
            of_texel.error = 0.25f;
            of_texel.rays = static_cast<std::uint32_t>(light.size());
        }
        fill_hidden(values, mask, charts, atlas.page_size, atlas.page_size);
        dilate(values, mask, atlas.page_size, atlas.page_size, std::max(1u, atlas.padding));
    }
    [[nodiscard]] std::size_t place(const Texel& texel) const {
        return std::size_t{texel.y} * made->atlas.page_size + texel.x;
    }
    [[nodiscard]] PageLayerInput input() const {
        return {made->scene, made->atlas, made->texels, made->patches, 0, mask, light};
    }
    [[nodiscard]] std::vector<float> floats(Layer layer) const {
        return std::get<std::vector<float>>(page_layer(input(), layer));
    }
    [[nodiscard]] std::vector<std::uint32_t> numbers(Layer layer) const {
        return std::get<std::vector<std::uint32_t>>(page_layer(input(), layer));
    }
};

TEST(PageLayers, AlbedoAndNormalAreThoseOfTheSurface) {
    const MadePage page;
    const std::vector<float> albedo = page.floats(Layer::albedo), normal = page.floats(Layer::normal);
    const PageTexels& content = page.made->texels.pages[0];
    const Scene& scene = page.made->scene;
    std::array<std::size_t, 3> seen{};
    for (const Texel& texel : content.texels) {
        const std::uint32_t object = page.made->atlas.charts[texel.chart].object;
        ++seen[object];
        const float* rho = &albedo[3 * page.place(texel)];
        const float* n = &normal[3 * page.place(texel)];
        const Rgb expected = object == 0   ? Rgb(0.75f, 0.5f, 0.25f)
                             : object == 1 ? Rgb(0.125f, 0.25f, 1)
                                           : Rgb(0.5f, 0.5f, 0.5f);
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(rho[c], expected[c], 1e-6);
        EXPECT_NEAR(n[0] * n[0] + n[1] * n[1] + n[2] * n[2], 1, 1e-5);
        if (object == 0) {
            EXPECT_NEAR(n[1], 1, 1e-6) << "the floor looks up";
        } else if (object == 1) {
            EXPECT_NEAR(std::max({std::abs(n[0]), std::abs(n[1]), std::abs(n[2])}), 1, 1e-6) << "a side of the block";
        } else {
            const Vec3d at = scene.origin + to_double(texel_surface(scene, page.made->atlas, content, texel).position);
            const Vec3d outwards = (at - Vec3d(0.5, 1, 0.5)).normalized();
            EXPECT_GT(outwards.dot(Vec3d(n[0], n[1], n[2])), 0.95) << "the ball looks away from its middle";
        }
    }
    for (const std::size_t count : seen) EXPECT_GT(count, 100u);
    for (std::size_t at = 0; at < page.mask.size(); ++at)
        if (page.mask[at] == texel_empty) {
            EXPECT_EQ(albedo[3 * at] + std::abs(normal[3 * at + 1]), 0);
        }
}

TEST(PageLayers, NumbersAndStates) {
    const MadePage page;
    const auto patch = page.numbers(Layer::patch), chart = page.numbers(Layer::chart),
               valid = page.numbers(Layer::valid);
    const PageTexels& content = page.made->texels.pages[0];
    std::vector<bool> covered(page.mask.size());
    const auto area = page.floats(Layer::area);
    std::size_t hidden = 0, filled = 0;
    double floor_m2 = 0;
    for (const Texel& texel : content.texels) {
        const std::size_t at = page.place(texel);
        covered[at] = true;
        EXPECT_EQ(chart[at], texel.chart);
        if (page.made->atlas.charts[texel.chart].object == 0) floor_m2 += static_cast<double>(area[at]);
        EXPECT_EQ(valid[at], content.can_send(texel) ? valid_covered : valid_hidden);
        hidden += valid[at] == valid_hidden;
        if (valid[at] == valid_covered) {
            ASSERT_LT(patch[at], page.made->patches.count());
            EXPECT_EQ(page.made->patches.patches[patch[at]].chart, texel.chart);
        }
    }
    // The block covers one of the nine square metres of the floor, less a texel all around, and half of it is below the
    // floor, but in the open.
    EXPECT_GE(hidden, 36u);
    EXPECT_NEAR(floor_m2, 9 - 1, 0.05) << "the floor but for what the block stands on";
    for (std::size_t at = 0; at < covered.size(); ++at) {
        if (covered[at]) continue;
        EXPECT_EQ(patch[at], 0xffffffffu);
        EXPECT_EQ(chart[at], 0xffffffffu);
        EXPECT_EQ(area[at], 0);
        EXPECT_TRUE(valid[at] == valid_none || valid[at] == valid_filled);
        EXPECT_EQ(valid[at] == valid_filled, page.mask[at] == texel_filled);
        filled += valid[at] == valid_filled;
    }
    EXPECT_GT(filled, 100u);
}

TEST(PageLayers, LightIsFilledLikeTheLightmap) {
    const MadePage page;
    const auto direct = page.floats(Layer::direct), indirect = page.floats(Layer::indirect),
               error = page.floats(Layer::error);
    const auto samples = page.numbers(Layer::samples);
    const PageTexels& content = page.made->texels.pages[0];
    const std::uint32_t size = page.made->atlas.page_size;
    std::vector<Rgb> sum(page.mask.size(), Rgb(0, 0, 0));
    std::vector<std::uint8_t> mask(page.mask.size(), texel_empty);
    std::vector<std::uint32_t> rays(page.mask.size());
    for (std::size_t k = 0; k < content.texels.size(); ++k) {
        const std::size_t at = page.place(content.texels[k]);
        sum[at] = page.light[k].irradiance();
        mask[at] = content.can_send(content.texels[k]) ? texel_covered : texel_hidden;
        if (mask[at] == texel_covered) rays[at] = page.light[k].rays;
    }
    fill_hidden(sum, mask, page.charts, size, size);
    dilate(sum, mask, size, size, std::max(1u, page.made->atlas.padding));
    ASSERT_EQ(mask, page.mask);
    for (std::size_t at = 0; at < mask.size(); ++at) {
        for (std::size_t c = 0; c < 3; ++c) {
            const float expected = mask[at] == texel_empty ? 0 : sum[at][static_cast<int>(c)];
            EXPECT_NEAR(direct[3 * at + c] + indirect[3 * at + c], expected, 1e-5f * std::max(1.0f, expected));
        }
        EXPECT_EQ(samples[at], rays[at]);
        EXPECT_EQ(error[at], rays[at] ? 0.25f : 0.0f);
    }
}

TEST(PageLayers, TheFileHasAPartForEach) {
    const MadePage page;
    std::vector<Layer> layers;
    for (const LayerInfo& info : all_layers) layers.push_back(info.layer);
    const Bytes file = layers_exr(page.input(), layers, "luxel test");
    EXPECT_EQ(file, layers_exr(page.input(), layers, "luxel test"));
    const auto parts = test::read_exr_parts(file);
    ASSERT_EQ(parts.size(), all_layers.size());
    for (std::size_t k = 0; k < parts.size(); ++k) {
        const LayerInfo& info = all_layers[k];
        EXPECT_EQ(parts[k].name, info.name);
        EXPECT_EQ(parts[k].texts.at("quantity"), info.quantity);
        EXPECT_EQ(parts[k].texts.at("Software"), "luxel test");
        std::string channels;
        for (const std::string& channel : parts[k].channels) channels += channel;
        EXPECT_EQ(channels, info.channels);
        if (info.sample == ExrSample::uint_32)
            EXPECT_EQ(parts[k].numbers, page.numbers(info.layer));
        else
            EXPECT_EQ(parts[k].floats, page.floats(info.layer));
    }
}

TEST(PageLayers, WhatDoesNotFitIsAFault) {
    const MadePage page;
    PageLayerInput input = page.input();
    input.light = input.light.first(3);
    EXPECT_THROW((void)page_layer(input, Layer::direct), Error);
    EXPECT_NO_THROW((void)page_layer(input, Layer::albedo));
    input.mask = input.mask.first(3);
    EXPECT_THROW((void)page_layer(input, Layer::albedo), Error);
}

TEST(Layers, NamesOfLists) {
    EXPECT_EQ(parse_layers("valid,albedo,valid", "--aov"), (std::vector{Layer::albedo, Layer::valid}));
    EXPECT_EQ(layer_names(parse_layers("valid,albedo", "--aov")), "albedo,valid");
    EXPECT_EQ(layer_names({}), "none");
    for (const LayerInfo& info : all_layers) EXPECT_STREQ(layer_info(info.layer).name, info.name);
    for (const char* wrong : {"", ",", "albedo,", "Albedo", "albedo normal", " albedo", "albedo,,valid", "beauty"}) {
        try {
            (void)parse_layers(wrong, "--aov");
            ADD_FAILURE() << wrong;
        } catch (const Error& error) {
            EXPECT_EQ(error.code, ErrorCode::usage);
            EXPECT_NE(std::string(error.what()).find("albedo"), std::string::npos) << "the known names are listed";
        }
    }
}

TEST(Layers, MemoryIsCounted) {
    EXPECT_EQ(layer_bytes_per_texel({}), 0u);
    const std::vector<Layer> one{Layer::valid}, two{Layer::albedo, Layer::valid}, light{Layer::direct};
    EXPECT_EQ(layer_bytes_per_texel(one), 1u + 4 + 2 * 4);
    EXPECT_EQ(layer_bytes_per_texel(two), 1u + 2 * 12 + 2 * 16);
    EXPECT_EQ(layer_bytes_per_texel(light), 1u + sizeof(TexelLight) + 2 * 12 + 1 + 2 * 12);
}

}  // namespace
}  // namespace luxel
