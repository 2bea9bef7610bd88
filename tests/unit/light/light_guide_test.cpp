/// Guided rays: the warp is a distribution, points where the light comes from, and changes no mean.
#include "baker/light/light_guide.h"

#include <gtest/gtest.h>

#include <cmath>

#include "baker/core/sampling.h"
#include "baker/core/sobol.h"
#include "baker/core/units.h"
#include "baker/formfactors/memory_blocks.h"
#include "baker/formfactors/sky_bins.h"
#include "baker/formfactors/sky_view.h"
#include "baker/light/gather.h"
#include "baker/light/sky.h"
#include "tests/support/scenes.h"
#include "tests/support/temporary_folder.h"

namespace luxel {
namespace {

using test::Prepared;
using test::quad;
using test::SceneMaker;

constexpr std::uint32_t cells = LightGuides::cells;

std::array<std::uint8_t, cells> spot_table() {
    std::array<std::uint8_t, cells> weights{};
    for (std::uint32_t c = 0; c < cells; ++c) weights[c] = static_cast<std::uint8_t>(c % 7);
    weights[3 * LightGuides::side + 12] = 255;
    return weights;
}

TEST(CosineSquare, IsTheInverseOfTheCosineMap) {
    const SobolSequence points(3);
    for (std::uint32_t k = 0; k < 4096; ++k) {
        const auto u = points.point(k);
        const Vec2f back = cosine_square(cosine_direction(u[0], u[1]));
        EXPECT_NEAR(back.x, u[0], 2e-6f);
        EXPECT_NEAR(back.y, u[1], 2e-6f);
    }
}

TEST(GuideWarp, DensityIsThatOfItsPoints) {
    const auto weights = spot_table();
    const GuideWarp warp{std::span<const std::uint8_t, cells>(weights)};
    const SobolSequence points(5);
    constexpr std::uint32_t count = 1 << 16;
    std::array<double, cells> seen{};
    double integral = 0;
    for (std::uint32_t k = 0; k < count; ++k) {
        const auto u = points.point(k);
        const GuideWarp::Point bent = warp.bend(u[0], u[1]);
        ASSERT_GE(bent.u, 0);
        ASSERT_LT(bent.u, 1);
        ASSERT_GE(bent.v, 0);
        ASSERT_LT(bent.v, 1);
        const auto cell = static_cast<std::uint32_t>(bent.v * LightGuides::side) * LightGuides::side + static_cast<std::uint32_t>(bent.u * LightGuides::side);
        ++seen[cell];
        integral += 1 / static_cast<double>(bent.density) / count;  // of 1 over the square
        const Vec3f local = cosine_direction(bent.u, bent.v);
        const Vec2f square = cosine_square(local);
        const auto inside = [](float x) { return std::fabs(x * LightGuides::side - std::round(x * LightGuides::side)) > 1e-3f; };
        if (inside(square.x) && inside(square.y)) {
            ASSERT_EQ(warp.density(local), bent.density);
        }
    }
    EXPECT_NEAR(integral, 1, 1e-3);
    for (std::uint32_t c = 0; c < cells; ++c) {
        const float x = (static_cast<float>(c % LightGuides::side) + 0.5f) / LightGuides::side;
        const float y = (static_cast<float>(c / LightGuides::side) + 0.5f) / LightGuides::side;
        const auto expected = static_cast<double>(warp.density(cosine_direction(x, y))) * count / cells;
        EXPECT_NEAR(seen[c], expected, 0.02 * expected + 4) << c;
    }
}

TEST(GuideWarp, WithoutWeightsAndInEvenLightItIsThePlainDistribution) {
    for (const std::uint8_t level : {std::uint8_t{0}, std::uint8_t{9}}) {
        std::array<std::uint8_t, cells> weights;
        weights.fill(level);
        const GuideWarp warp{std::span<const std::uint8_t, cells>(weights)};
        const GuideWarp::Point bent = warp.bend(0.3f, 0.8f);
        EXPECT_NEAR(bent.u, 0.3f, 1e-6f);
        EXPECT_NEAR(bent.v, 0.8f, 1e-6f);
        EXPECT_NEAR(bent.density, 1, 1e-5f);
    }
}

/// A floor, and above its left and right two small quads that look down.
std::unique_ptr<Prepared> floor_under_two() {
    return test::prepare(SceneMaker()
                             .add("floor", quad({-0.25f, 0, -0.25f}, {0, 0, 0.5f}, {0.5f, 0, 0}))
                             .add("left", quad({-1.25f, 1, -0.25f}, {0.5f, 0, 0}, {0, 0, 0.5f}))
                             .add("right", quad({0.75f, 1, -0.25f}, {0.5f, 0, 0}, {0, 0, 0.5f}))
                             .build(),
                         {.texels_per_metre = 8, .chunk_patches = 16});
}

/// Any matrix will do: every floor patch exchanges the same with all others.
MemoryBlocks even_matrix(const Prepared& made) {
    std::vector<ExchangePair> pairs;
    for (PatchNumber i = 0; i < made.patches.count(); ++i)
        for (PatchNumber j = i + 1; j < made.patches.count(); ++j)
            if ((made.path_of(i) == "floor") != (made.path_of(j) == "floor")) pairs.push_back({i, j, 1e-3f});
    return {made.layout, made.area_m2(), std::vector<double>(made.patches.count(), 0), pairs};
}

TEST(LightGuides, PointWhereTheLightComesFrom) {
    const auto made = floor_under_two();
    MemoryBlocks matrix = even_matrix(*made);
    std::vector<float> reflected, emitted;
    for (PatchNumber p = 0; p < made->patches.count(); ++p) {
        reflected.push_back(made->path_of(p) == "left" ? 3.0f : 0.0f);
        emitted.push_back(made->path_of(p) == "right" ? 1.0f : 0.0f);
    }
    const LightGuides guides(matrix, made->patches, reflected, emitted);
    ASSERT_FALSE(guides.empty());
    for (PatchNumber p = 0; p < made->patches.count(); ++p) {
        const bool is_floor = made->path_of(p) == "floor";
        EXPECT_NEAR(guides.emitted_share(p), is_floor ? 0.25f : 0.0f, 1e-5f) << made->path_of(p);
        if (!is_floor) continue;
        const GuideWarp warp(guides.of(p));
        const Frame frame(made->patches.patches[p].normal);
        const Vec3f to_left = (Vec3f(-1, 1, 0) - made->patches.patches[p].center).normalized();
        const Vec3f to_right = (Vec3f(1, 1, 0) - made->patches.patches[p].center).normalized();
        EXPECT_GT(warp.density(frame.to_local(to_left)), 5);
        EXPECT_LT(warp.density(frame.to_local(to_right)), 1);
    }
}

/// Right, wrong or absent: the guide changes the noise, never the mean.
TEST(LightGuides, KeepTheMean) {
    const auto made = floor_under_two();
    MemoryBlocks matrix = even_matrix(*made);
    std::vector<Rgb> radiosity;
    std::vector<float> right, wrong, dark(made->patches.count(), 0);
    for (PatchNumber p = 0; p < made->patches.count(); ++p) {
        const bool is_left = made->path_of(p) == "left";
        radiosity.push_back(is_left ? Rgb(100, 50, 25) : Rgb(0, 0, 0));
        right.push_back(is_left ? 1.0f : 0.0f);
        wrong.push_back(made->path_of(p) == "right" ? 1.0f : 0.0f);
    }
    const EmitterSet emitters(made->scene, made->atlas, made->patches);
    const RadiosityDetail detail(radiosity);
    const auto moments = [&](const LightGuides& guides) {
        const GatherInput input{made->scene, made->atlas, made->texels, made->patches, *made->tracer, emitters, detail, guides};
        double sum = 0, noise = 0;
        for (std::uint32_t page = 0; page < made->texels.pages.size(); ++page) {
            const auto gathered = gather_page(input, page, {.rays = 32}, nullptr);
            const auto& halves = gathered->reflected.halves;
            for (std::size_t k = 0; k < halves[0].size(); ++k) {
                if (made->scene.objects[made->atlas.charts[made->texels.pages[page].texels[k].chart].object].first_triangle != 0) continue;
                sum += static_cast<double>(halves[0][k].x + halves[1][k].x) / 2;
                noise += std::pow(static_cast<double>(halves[0][k].x - halves[1][k].x) / 2, 2);
            }
        }
        return std::pair(sum, std::sqrt(noise));
    };
    const auto plain = moments(LightGuides());
    const auto guided = moments(LightGuides(matrix, made->patches, right, dark));
    const auto misled = moments(LightGuides(matrix, made->patches, wrong, dark));
    ASSERT_GT(plain.first, 0);
    EXPECT_NEAR(guided.first, plain.first, 4 * (plain.second + guided.second));
    EXPECT_NEAR(misled.first, plain.first, 4 * (plain.second + misled.second));
    std::printf("noise: plain %.3f, guided %.3f, misled %.3f\n", plain.second, guided.second, misled.second);
    EXPECT_LT(guided.second, 0.7 * plain.second);
}

/// The sky through a hole of 20 cm in a roof: rays know where it is, the mean stays.
TEST(LightGuides, PointAtTheOpenSky) {
    // A room of 2 x 2 x 0.5 m; its roof and walls look down and in.
    const auto made = test::prepare(SceneMaker()
                                        .add("floor", quad({-0.25f, 0, -0.25f}, {0, 0, 0.5f}, {0.5f, 0, 0}))
                                        .add("left", quad({-1, 0.5f, -1}, {1.4f, 0, 0}, {0, 0, 2}))
                                        .add("right", quad({0.6f, 0.5f, -1}, {0.4f, 0, 0}, {0, 0, 2}))
                                        .add("before", quad({0.4f, 0.5f, -1}, {0.2f, 0, 0}, {0, 0, 0.9f}))
                                        .add("behind", quad({0.4f, 0.5f, 0.1f}, {0.2f, 0, 0}, {0, 0, 0.9f}))
                                        .add("west", quad({-1, 0, -1}, {0, 0.5f, 0}, {0, 0, 2}))
                                        .add("east", quad({1, 0, -1}, {0, 0, 2}, {0, 0.5f, 0}))
                                        .add("north", quad({-1, 0, -1}, {2, 0, 0}, {0, 0.5f, 0}))
                                        .add("south", quad({-1, 0, 1}, {0, 0.5f, 0}, {2, 0, 0}))
                                        .build(),
                                    {.texels_per_metre = 16, .patch_texels = 2});
    const auto count = static_cast<PatchNumber>(made->patches.count());
    const test::TemporaryFolder folder;
    const Key key = KeyBuilder("test").finish();
    SkyViewWriter file(folder / "sky", key, count, 256);
    for (PatchNumber begin = 0; begin < count; begin += sky_view_block)
        file.append(count_sky_rays(made->scene, made->atlas, made->patches, *made->tracer, begin, std::min(begin + sky_view_block, count), {256, 0}));
    file.publish();
    const SkyInView view(folder / "sky", key, count, std::vector<Rgb>(sky_bin_count, Rgb(2, 2, 2)));
    MemoryBlocks matrix(made->layout, made->area_m2(), std::vector<double>(count, 0), std::vector<ExchangePair>());
    const std::vector<float> dark(count, 0);
    const LightGuides guides(matrix, made->patches, dark, dark, &view);
    const EmitterSet emitters(made->scene, made->atlas, made->patches);
    const RadiosityDetail radiosity(std::vector<Rgb>(count, Rgb(0, 0, 0)));
    const SkyMap map{1, 1, {Rgb(2, 2, 2)}, 0};
    const Sky sky(map);
    const auto moments = [&](const LightGuides& used) {
        const GatherInput input{made->scene, made->atlas, made->texels, made->patches, *made->tracer, emitters, radiosity, used, &sky};
        const auto gathered = gather_page(input, 0, {.rays = 64}, nullptr);
        double sum = 0, noise = 0;
        for (std::size_t k = 0; k < made->texels.pages[0].texels.size(); ++k) {
            if (made->atlas.charts[made->texels.pages[0].texels[k].chart].object != 0) continue;
            sum += static_cast<double>(gathered->emitted.halves[0][k].x + gathered->emitted.halves[1][k].x) / 2;
            noise += std::pow(static_cast<double>(gathered->emitted.halves[0][k].x - gathered->emitted.halves[1][k].x) / 2, 2);
        }
        return std::pair(sum, std::sqrt(noise));
    };
    for (PatchNumber p = 0; p < count; ++p) {
        if (made->path_of(p) != "floor") continue;
        const GuideWarp warp(guides.of(p));
        const Frame frame(made->patches.patches[p].normal);
        EXPECT_GT(warp.density(frame.to_local((Vec3f(0.5f, 0.5f, 0) - made->patches.patches[p].center).normalized())), 2);
        EXPECT_LT(warp.density(frame.to_local(Vec3f(-1, 0.6f, 0).normalized())), 0.6f);
    }
    const auto plain = moments(LightGuides()), guided = moments(guides);
    ASSERT_GT(plain.first, 0);
    EXPECT_NEAR(guided.first, plain.first, 4 * (plain.second + guided.second));
    std::printf("noise: plain %.3f, guided %.3f\n", plain.second, guided.second);
    EXPECT_LT(guided.second, 0.7 * plain.second);
}

}  // namespace
}  // namespace luxel
