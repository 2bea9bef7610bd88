/// What rays find must become certain as they become more: with 16 times as many points, independent ones leave a quarter of the noise and
/// well-spread ones less. Where points on the surface and on what they look at went together, hardly any of the noise would go.
#include <gtest/gtest.h>

#include <cmath>

#include "baker/light/gather.h"
#include "baker/light/sky.h"
#include "baker/light/texel_lamps.h"
#include "tests/support/scenes.h"

namespace luxel {
namespace {

using test::Prepared;
using test::quad;
using test::SceneMaker;

/// A quarter, and room for chance.
constexpr double most_left = 0.33;

/// Root mean square of what two estimates of the same texels differ by, lux.
double noise(std::span<const Rgb> first, std::span<const Rgb> second) {
    double sum = 0;
    for (std::size_t k = 0; k < first.size(); ++k) {
        const auto difference = static_cast<double>(first[k].x - second[k].x);
        sum += difference * difference;
    }
    return std::sqrt(sum / static_cast<double>(first.size()));
}

GatheredPage gathered(const Prepared& made, const GatherOptions& options, const Sky* sky = nullptr) {
    const EmitterSet emitters(made.scene, made.atlas, made.patches);
    const RadiosityDetail radiosity(std::vector<Rgb>(made.patches.count(), Rgb(0, 0, 0)));
    const LightGuides guides;
    const GatherInput input{made.scene, made.atlas, made.texels, made.patches, *made.tracer, emitters, radiosity, guides, sky};
    EXPECT_EQ(made.texels.pages.size(), 1u);
    return *gather_page(input, 0, options, nullptr);
}

double noise_of_emitted(const Prepared& made, std::uint32_t rays, const Sky* sky = nullptr) {
    const GatheredPage found = gathered(made, {.rays = rays}, sky);
    return noise(found.emitted.halves[0], found.emitted.halves[1]);
}

/// A floor that a plate half covers: penumbras, some as wide as texels.
SceneMaker floor_under_plate() {
    return SceneMaker()
        .add("floor", quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}))
        .add("plate", quad({-0.6f, 0.3f, -0.6f}, {0, 0, 1}, {1, 0, 0}), {{0.5, 0.5, 0.5}, {0, 0, 0}, true});
}

TEST(Convergence, PenumbrasOfEmitters) {
    test::MadeMaterial lamp;
    lamp.nits = {1000, 1000, 1000};
    // Of several patches, so that patch and point are both chosen.
    const auto made = test::prepare(floor_under_plate().add("lamp", quad({-0.3f, 1.5f, -0.3f}, {0.6f, 0, 0}, {0, 0, 0.6f}), lamp).build(),
                                    {.texels_per_metre = 6, .patch_texels = 1});
    EXPECT_LT(noise_of_emitted(*made, 4096), most_left * noise_of_emitted(*made, 256));
}

TEST(Convergence, PenumbrasOfABrightDiskInTheSky) {
    SkyMap map{64, 32, std::vector<Rgb>(64 * 32, Rgb(1, 1, 1)), 0};
    for (const std::size_t y : {8u, 9u})
        for (const std::size_t x : {20u, 21u, 22u}) map.nits[y * 64 + x] = Rgb(5000, 5000, 5000);
    const Sky sky(map);
    const auto made = test::prepare(floor_under_plate().build(), {.texels_per_metre = 6});
    EXPECT_LT(noise_of_emitted(*made, 4096, &sky), most_left * noise_of_emitted(*made, 256, &sky));
}

TEST(Convergence, PenumbrasOfASizedLamp) {
    auto made = test::prepare(floor_under_plate().build(), {.texels_per_metre = 6});
    Lamp lamp;
    lamp.position = {0.1f, 1.5f, 0.2f};
    lamp.direction = {0, -1, 0};
    lamp.intensity = {100, 100, 100};
    lamp.radius = 0.3f;
    made->scene.lamps = {lamp};
    const std::vector<float> other(made->texels.pages[0].texels.size(), 0);
    const auto light = [&](std::uint32_t points, std::uint64_t seed) {
        return *texel_lamps(made->scene, made->atlas, made->texels.pages[0], made->texels.page_size, *made->tracer, other, {points, 0, seed, nullptr});
    };
    const auto noise_with = [&](std::uint32_t points) { return noise(light(points, 1), light(points, 2)); };
    EXPECT_LT(noise_with(1024), most_left * noise_with(64));
}

/// Around a box in a room, where most hits are near: points on the texel, of the bounce and on the lamp belong to three patterns.
TEST(Convergence, LightThatIsFollowedOn) {
    test::MadeMaterial lamp;
    lamp.nits = {1000, 1000, 1000};
    const auto made = test::prepare(SceneMaker()
                                        .add("walls", test::room({0, 0, 0}, {2, 2, 2}))
                                        .add("lamp", quad({0.7f, 1.9f, 0.7f}, {0.6f, 0, 0}, {0, 0, 0.6f}), lamp)
                                        .add("box", test::moved(test::box(0.6f, 0.8f, 0.6f), {0.2f, 0.1f, 0.3f}))
                                        .build(),
                                    {.texels_per_metre = 5});
    const auto noise_with = [&](std::uint32_t rays) {
        const GatheredPage found = gathered(*made, {.rays = rays, .near_m = 0.8f});
        return noise(found.reflected.halves[0], found.reflected.halves[1]);
    };
    EXPECT_LT(noise_with(4096), most_left * noise_with(256));
}

}  // namespace
}  // namespace luxel
