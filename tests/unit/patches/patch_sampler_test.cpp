/// Points on patches: on the surface, in the right texels, uniform, and as well spread as the pattern they are made of.
#include "baker/patches/patch_sampler.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "baker/core/sobol.h"
#include "tests/support/scenes.h"

namespace luxel {
namespace {

using test::Prepared;
using test::quad;
using test::SceneMaker;

std::unique_ptr<Prepared> made_scene() {
    test::MadeMaterial two_sided;
    two_sided.double_sided = true;
    return test::prepare(SceneMaker()
                             .add("walls", test::room({0, 0, 0}, {3, 2, 2.3f}))
                             .add("ball", test::moved(test::icosphere(2, 0.6f), {1, 1, 1}))
                             .add("sheet", quad({2, 0.5f, 0.5f}, {0, 1, 0.3f}, {0.3f, 0, 1}), two_sided)
                             .build());
}

TEST(PatchSampler, PointsLieOnThePatch) {
    const auto made = made_scene();
    const SobolSequence sequence(1);
    for (PatchNumber p = 0; p < made->patches.count(); ++p) {
        const PatchSampler sampler(made->scene, made->atlas, made->patches, p);
        const Patch& patch = made->patches.patches[p];
        const Chart& chart = made->atlas.charts[patch.chart];
        for (std::uint32_t k = 0; k < 64; ++k) {
            const auto u = sequence.point(k);
            const SurfacePoint at = sampler.point(u[0], u[1]);
            EXPECT_NEAR((at.position - surface_position(made->scene, at.triangle, at.barycentric)).length(), 0, 1e-6);
            const Vec3f front = made->scene.geometric_normal(at.triangle);
            EXPECT_NEAR((at.normal - (patch.is_back ? -front : front)).length(), 0, 1e-6);
            const Vec2f* uv = &made->atlas.corner_uv[std::size_t{3} * at.triangle];
            const Vec2f place = uv[0] + (uv[1] - uv[0]) * at.barycentric.x + (uv[2] - uv[0]) * at.barycentric.y;
            constexpr float rounding = 1e-3f;  // of a texel
            EXPECT_TRUE(std::ranges::any_of(made->patches.fragments_of(p),
                                            [&](const Fragment& fragment) {
                                                const float x = static_cast<float>(fragment.x - chart.x),
                                                            y = static_cast<float>(fragment.y - chart.y);
                                                return place.x > x - rounding &&
                                                       place.x < x + 1 + rounding && place.y > y - rounding &&
                                                       place.y < y + 1 + rounding;
                                            }))
                << "patch " << p;
        }
    }
}

/// Each fragment gets its share of the points, and their mean is the centre of the patch.
TEST(PatchSampler, UniformOverTheArea) {
    const auto made = made_scene();
    std::size_t flat = 0, cut = 0;
    for (PatchNumber p = 0; p < made->patches.count(); p += 3) {
        const PatchSampler sampler(made->scene, made->atlas, made->patches, p);
        ++(sampler.flat() ? flat : cut);
        const Patch& patch = made->patches.patches[p];
        std::map<std::uint32_t, double> share, area;
        for (const Fragment& fragment : made->patches.fragments_of(p))
            area[fragment.triangle] += static_cast<double>(fragment.area_m2 / patch.area_m2);
        Vec3d mean(0, 0, 0);
        constexpr std::uint32_t points = 4096;
        const SobolSequence sequence(patch.id);
        for (std::uint32_t k = 0; k < points; ++k) {
            const auto u = sequence.point(k);
            const SurfacePoint at = sampler.point(u[0], u[1]);
            share[at.triangle] += 1.0 / points;
            mean += to_double(at.position) / points;
        }
        // On a flat patch one triangle stands for all that continue it.
        if (sampler.flat()) area.clear();
        for (const auto& [triangle, expected] : area) EXPECT_NEAR(share[triangle], expected, 0.01);
        EXPECT_LT((mean - to_double(patch.center)).length(),
                  0.005 * std::sqrt(static_cast<double>(patch.area_m2)) + 1e-6);
    }
    EXPECT_GT(flat, 5u);
    EXPECT_GT(cut, 20u);
}

/// Inside of one large triangle the sampler is a parallelogram, and the strata of the pattern are strata of the
/// surface.
TEST(PatchSampler, FlatPatchesKeepStrata) {
    const auto made = test::prepare(SceneMaker().add("floor", quad({0, 0, 0}, {0, 0, 4}, {4, 0, 0})).build());
    std::size_t tested = 0;
    for (PatchNumber p = 0; p < made->patches.count(); ++p) {
        const PatchSampler sampler(made->scene, made->atlas, made->patches, p);
        const Parallelogram* flat = sampler.flat();
        if (!flat) continue;
        ++tested;
        EXPECT_NEAR(flat->side_u.cross(flat->side_v).length(), made->patches.patches[p].area_m2,
                    1e-5f * made->patches.patches[p].area_m2);
        std::array<int, 256> met{};
        const SobolSequence sequence(p);
        for (std::uint32_t k = 0; k < 256; ++k) {
            const auto u = sequence.point(k);
            const SurfacePoint at = sampler.point(u[0], u[1]);
            EXPECT_EQ(at.position, flat->origin + flat->side_u * u[0] + flat->side_v * u[1]);
            const Vec3f from = at.position - flat->origin;
            const float x = from.dot(flat->side_u) / flat->side_u.length2(),
                        y = from.dot(flat->side_v) / flat->side_v.length2();
            const auto column = static_cast<std::size_t>(std::clamp(x * 16, 0.0f, 15.0f));
            const auto row = static_cast<std::size_t>(std::clamp(y * 16, 0.0f, 15.0f));
            ++met[row * 16 + column];
        }
        // A net of 256 points has one in each of the 16 x 16 cells, but for the rounding at their borders.
        EXPECT_LE(std::ranges::count_if(met, [](int count) { return count != 1; }), 4);
    }
    EXPECT_GT(tested, 20u);
}

TEST(PatchSampler, EndsOfTheUnitSquareAreLegal) {
    const auto made = made_scene();
    constexpr float last = 0x1.fffffep-1f;
    for (PatchNumber p = 0; p < made->patches.count(); ++p) {
        const PatchSampler sampler(made->scene, made->atlas, made->patches, p);
        for (const auto& [u, v] : {std::pair{0.0f, 0.0f}, {last, 0.0f}, {0.0f, last}, {last, last}}) {
            const SurfacePoint at = sampler.point(u, v);
            EXPECT_LT(at.triangle, made->scene.triangle_count());
            if (sampler.flat()) continue;  // may lie on a triangle that continues this one
            EXPECT_GE(at.barycentric.x, -1e-4f);
            EXPECT_GE(at.barycentric.y, -1e-4f);
            EXPECT_LE(at.barycentric.x + at.barycentric.y, 1 + 1e-4f);
        }
    }
}

TEST(PatchSampler, ShadingNormalsTurnWithTheSide) {
    const auto made = made_scene();
    std::size_t backs = 0;
    for (PatchNumber p = 0; p < made->patches.count(); ++p) {
        const PatchSampler sampler(made->scene, made->atlas, made->patches, p);
        const SurfacePoint at = sampler.point(0.3f, 0.7f);
        EXPECT_GT(sampler.shading_normal(at).dot(at.normal), 0);
        EXPECT_NEAR(sampler.shading_normal(at).length(), 1, 1e-5);
        backs += made->patches.patches[p].is_back;
    }
    EXPECT_GT(backs, 0u);
}

}  // namespace
}  // namespace luxel
