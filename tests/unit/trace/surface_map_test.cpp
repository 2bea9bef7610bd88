/// The one rule of sides: fronts belong to their patch, backs to the other side where there is one, else they absorb.
#include "baker/trace/surface_map.h"

#include <gtest/gtest.h>

#include "baker/patches/patch_sampler.h"
#include "tests/support/scenes.h"

namespace luxel {
namespace {

using test::quad;
using test::SceneMaker;

TEST(SurfaceMap, SidesAndTheOpen) {
    test::MadeMaterial two_sided;
    two_sided.double_sided = true;
    // Two sheets beside each other and a plate, so that both sides of the sheets see something.
    const auto made = test::prepare(SceneMaker()
                                        .add("one", quad({0, 1, 0}, {0, 0, 1}, {1, 0, 0}))
                                        .add("two", quad({2, 1, 0}, {0, 0, 1}, {1, 0, 0}), two_sided)
                                        .add("floor", quad({-2, 0, -2}, {0, 0, 6}, {8, 0, 0}))
                                        .add("ceiling", quad({-2, 2, -2}, {8, 0, 0}, {0, 0, 6}))
                                        .build());
    const auto land = [&](const Vec3f& from, const Vec3f& direction) {
        const TraceHit hit = made->tracer->first_hit({from - to_float(made->scene.origin), direction, none});
        return landing(made->scene, made->atlas, made->patches, hit);
    };
    const Landing front = land({0.5f, 1.5f, 0.5f}, {0, -1, 0});
    ASSERT_EQ(front.end, RayEnd::patch);
    EXPECT_EQ(made->path_of(front.patch), "one");
    EXPECT_EQ(land({0.5f, 0.5f, 0.5f}, {0, 1, 0}).end, RayEnd::back) << "the back of a one-sided sheet absorbs";
    const Landing upper = land({2.5f, 1.5f, 0.5f}, {0, -1, 0}), lower = land({2.5f, 0.5f, 0.5f}, {0, 1, 0});
    ASSERT_EQ(upper.end, RayEnd::patch);
    ASSERT_EQ(lower.end, RayEnd::patch);
    EXPECT_FALSE(made->patches.patches[upper.patch].is_back);
    EXPECT_TRUE(made->patches.patches[lower.patch].is_back);
    EXPECT_EQ(made->patches.patches[upper.patch].other_side, lower.patch);
    EXPECT_EQ(land({0.5f, 0.5f, 0.5f}, {1, 0, 0}).end, RayEnd::open);
}

/// A point sampled on a patch, met from its side, lands on that patch.
TEST(SurfaceMap, PointsOfAPatchLandOnIt) {
    test::MadeMaterial two_sided;
    two_sided.double_sided = true;
    const auto made = test::prepare(SceneMaker()
                                        .add("walls", test::room({0, 0, 0}, {3, 2, 4}))
                                        .add("ball", test::moved(test::icosphere(2, 0.5f), {1, 1, 1}))
                                        .add("sheet", quad({2, 0.5f, 1}, {0, 1, 0.3f}, {0.3f, 0, 1}), two_sided)
                                        .build());
    std::size_t tested = 0, elsewhere = 0, backs = 0;
    for (PatchNumber p = 0; p < made->patches.count(); ++p) {
        const PatchSampler sampler(made->scene, made->atlas, made->patches, p);
        backs += made->patches.patches[p].is_back;
        for (int k = 0; k < 16; ++k) {
            const SurfacePoint at =
                sampler.point((static_cast<float>(k % 4) + 0.37f) / 4, (static_cast<float>(k) + 0.5f) / 16);
            EXPECT_NEAR((at.position - surface_position(made->scene, at.triangle, at.barycentric)).length(), 0, 1e-5);
            const float close = 1e-3f;
            const TraceHit hit = made->tracer->first_hit({at.position + at.normal * close, -at.normal, none});
            if (hit.triangle == none || hit.distance_m > 2 * close) continue;  // an edge within a millimetre
            const Landing landed = landing(made->scene, made->atlas, made->patches, hit);
            ++tested;
            elsewhere += landed.end != RayEnd::patch || landed.patch != p;
        }
    }
    EXPECT_GT(backs, 0u);
    EXPECT_GT(tested, 3000u);
    // Points within rounding of a texel's border may fall to its neighbour.
    EXPECT_LE(elsewhere, tested / 1000);
}

}  // namespace
}  // namespace luxel
