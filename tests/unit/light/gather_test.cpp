/// Final gathering where the answer is known: inside a furnace, under a sun; and what it may not depend on.
#include "baker/light/gather.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "baker/core/parallel.h"
#include "tests/support/scenes.h"

namespace luxel {
namespace {

using test::Prepared;
using test::quad;
using test::SceneMaker;

std::vector<std::vector<Rgb>> gather(const Prepared& made, std::span<const Rgb> radiosity,
                                     const GatherOptions& options) {
    const EmitterSet emitters(made.scene, made.atlas, made.patches);
    std::vector<Rgb> reflected;
    for (std::size_t p = 0; p < radiosity.size(); ++p) reflected.push_back(radiosity[p] - made.patches.patches[p].emission);
    const RadiosityDetail detail(reflected);
    const LightGuides guides;
    const GatherInput input{made.scene, made.atlas, made.texels, made.patches, *made.tracer, emitters, detail, guides};
    std::vector<std::vector<Rgb>> pages;
    for (std::uint32_t page = 0; page < made.texels.pages.size(); ++page)
        pages.push_back(gather_page(input, page, options, nullptr)->irradiance());
    return pages;
}

/// Mean and largest deviation from `expected`, relative, over all texels and channels.
struct Deviation {
    double mean = 0, largest = 0;
};

Deviation deviation(const Prepared& made, const std::vector<std::vector<Rgb>>& pages, const Rgb& expected) {
    Deviation found;
    double count = 0;
    for (std::size_t page = 0; page < pages.size(); ++page) {
        EXPECT_EQ(pages[page].size(), made.texels.pages[page].texels.size());
        for (const Rgb& h : pages[page])
            for (int c = 0; c < 3; ++c) {
                const double relative = static_cast<double>(h[c] / expected[c]) - 1;
                found.mean += relative;
                found.largest = std::max(found.largest, std::fabs(relative));
                ++count;
            }
    }
    found.mean /= count;
    return found;
}

TEST(Gather, InsideOfAFurnaceIsConstant) {
    for (const bool round : {false, true}) {
        const auto made = test::prepare(
            SceneMaker()
                .add("walls", round ? test::turned(test::icosphere(2, 1)) : test::room({0, 0, 0}, {2, 1, 1.5f}))
                .build());
        const Rgb radiosity(5, 0.25f, 1e4f);
        const std::vector<Rgb> all(made->patches.count(), radiosity);
        const Deviation found = deviation(*made, gather(*made, all, {.rays = 64}), radiosity);
        EXPECT_LT(found.largest, 1e-6);
    }
}

/// Walls that emit a part of their radiosity: aimed rays and cosine rays together still mean the same.
TEST(Gather, InsideOfAGlowingFurnaceIsConstantOnAverage) {
    test::MadeMaterial glowing;
    glowing.nits = {1, 2, 4};
    const auto made = test::prepare(SceneMaker().add("walls", test::room({0, 0, 0}, {2, 1, 1.5f}), glowing).build(),
                                    {.texels_per_metre = 6});
    const Rgb radiosity(10, 20, 40);  // emission is pi of them
    const std::vector<Rgb> all(made->patches.count(), radiosity);
    const Deviation aimed = deviation(*made, gather(*made, all, {.rays = 256}), radiosity);
    EXPECT_LT(std::fabs(aimed.mean), 0.005);
    EXPECT_LT(aimed.largest, 0.3);
    const Deviation plain = deviation(*made, gather(*made, all, {.rays = 256, .aim_at_emitters = false}), radiosity);
    EXPECT_LT(plain.largest, 1e-6);
}

/// A small lamp in a dark room: aiming changes the noise, not the mean.
TEST(Gather, AimingKeepsTheMean) {
    test::MadeMaterial lamp;
    lamp.nits = {1000, 1000, 1000};
    const auto made = test::prepare(SceneMaker()
                                        .add("walls", test::room({0, 0, 0}, {2, 2, 2}))
                                        .add("lamp", quad({0.8f, 1.9f, 0.8f}, {0.4f, 0, 0}, {0, 0, 0.4f}), lamp)
                                        .add("box", test::moved(test::box(0.5f, 0.8f, 0.5f), {0.3f, 0.02f, 0.4f}))
                                        .build(),
                                    {.texels_per_metre = 6});
    std::vector<Rgb> radiosity;
    for (const Patch& patch : made->patches.patches) radiosity.push_back(patch.emission);
    const auto total = [&](const GatherOptions& options) {
        const auto pages = gather(*made, radiosity, options);
        double sum = 0;
        for (std::size_t page = 0; page < pages.size(); ++page)
            for (std::size_t k = 0; k < pages[page].size(); ++k)
                sum += static_cast<double>(pages[page][k].x * made->texels.pages[page].texels[k].area_m2);
        return sum;
    };
    const double reference = total({.rays = 4096, .aim_at_emitters = false});
    EXPECT_NEAR(total({.rays = 256}) / reference, 1, 0.005);
    // What the surfaces receive is what the lamp sends; its backside is not one of them.
    EXPECT_NEAR(reference, 0.16 * 3.14159265 * 1000, 0.01 * reference);
}

LampRecord sun(double lux) {
    LampRecord lamp;
    lamp.kind = LampKind::directional;
    lamp.intensity = {lux, lux, lux};
    lamp.world = Imath::M44d(1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1);  // shines down
    return lamp;
}

TEST(Gather, SunOnAnOpenFloor) {
    const auto made = test::prepare(
        SceneMaker().add("slope", quad({0, 0, 0}, {0, 0.6f, 0.8f}, {1, 0, 0})).add_lamp(sun(100)).build());
    const std::vector<Rgb> dark(made->patches.count(), Rgb(0, 0, 0));
    const Deviation found = deviation(*made, gather(*made, dark, {.rays = 16}), Rgb(80, 80, 80));
    EXPECT_LT(found.largest, 1e-5);
}

std::unique_ptr<Prepared> furnished(std::uint32_t page_size, std::uint32_t chunk_patches) {
    test::MadeMaterial lamp;
    lamp.nits = {10, 10, 10};
    return test::prepare(SceneMaker()
                             .add("walls", test::room({0, 0, 0}, {2, 1.5f, 2}))
                             .add("lamp", quad({0.8f, 1.4f, 0.8f}, {0.4f, 0, 0}, {0, 0, 0.4f}), lamp)
                             .add("ball", test::moved(test::icosphere(1, 0.3f), {1, 0.5f, 1}))
                             .add_lamp(sun(3))
                             .build(),
                         {.texels_per_metre = 6, .page_size = page_size, .chunk_patches = chunk_patches});
}

std::vector<Rgb> radiosity_by_id(const Prepared& made) {
    std::vector<Rgb> radiosity;
    for (const Patch& patch : made.patches.patches)
        radiosity.push_back(patch.emission + Rgb(static_cast<float>(patch.id % 100), 1, 2));
    return radiosity;
}

TEST(Gather, SameForAnyThreads) {
    const auto made = furnished(256, 100);
    const auto radiosity = radiosity_by_id(*made);
    std::vector<std::vector<std::vector<Rgb>>> found;
    for (const unsigned threads : {1u, 2u}) {
        const ThreadLimit limit(threads);
        found.push_back(gather(*made, radiosity, {.rays = 32}));
    }
    EXPECT_EQ(found[0], found[1]);
}

/// Where a chart is packed is not seen in its texels.
TEST(Gather, DoesNotDependOnThePage) {
    using Place = std::array<std::uint32_t, 4>;
    const auto by_place = [](const Prepared& made) {
        const auto pages = gather(made, radiosity_by_id(made), {.rays = 32, .aim_at_emitters = false});
        std::map<Place, std::array<float, 3>> found;
        for (std::size_t page = 0; page < pages.size(); ++page)
            for (std::size_t k = 0; k < pages[page].size(); ++k) {
                const Texel& texel = made.texels.pages[page].texels[k];
                const Chart& chart = made.atlas.charts[texel.chart];
                const Rgb& h = pages[page][k];
                found[{chart.object, chart.ordinal, texel.x - chart.x, texel.y - chart.y}] = {h.x, h.y, h.z};
            }
        return found;
    };
    const auto large = furnished(256, 100), small = furnished(32, 30);
    EXPECT_GT(small->atlas.page_count, large->atlas.page_count);
    EXPECT_EQ(by_place(*large), by_place(*small));
}

TEST(Gather, EndsEmptyWhenItIsAskedToStop) {
    const auto made = test::prepare(SceneMaker().add("walls", test::room({0, 0, 0}, {2, 1, 1.5f})).build());
    StopRequest stop;
    stop.ask();
    GatherOptions options;
    options.stop = &stop;
    const EmitterSet emitters(made->scene, made->atlas, made->patches);
    const RadiosityDetail detail(std::vector<Rgb>(made->patches.count(), Rgb(1, 1, 1)));
    const LightGuides guides;
    const GatherInput input{made->scene, made->atlas, made->texels, made->patches, *made->tracer, emitters, detail, guides};
    for (std::uint32_t page = 0; page < made->texels.pages.size(); ++page) EXPECT_FALSE(gather_page(input, page, options, nullptr));
}

}  // namespace
}  // namespace luxel
