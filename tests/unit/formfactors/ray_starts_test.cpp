/// Many starts at once against one at a time, on flat, curved, two-sided and sunk surfaces.
#include "baker/formfactors/ray_starts.h"

#include <gtest/gtest.h>

#include <cmath>

#include "baker/core/ray_offset.h"
#include "tests/unit/formfactors/made_evidence_scene.h"

namespace luxel {
namespace {

TEST(RayStarts, AreThoseOfTheSampler) {
    test::SceneMaker maker;
    test::add_furnished_room(maker, "room", Vec3d(0, 0, 0));
    maker.add("sunk", test::moved(test::box(0.5f, 0.5f, 0.5f), {2.3f, -0.2f, 0.2f}));
    const auto made = test::prepare(maker.build());
    std::size_t compared = 0, elsewhere = 0, flat = 0, cut = 0;
    for (PatchNumber patch = 0; patch < made->patches.count(); ++patch) {
        const PatchSampler sampler(made->scene, made->atlas, made->patches, patch);
        const RayStarts starts(made->scene, sampler);
        flat += sampler.flat() != nullptr;
        for (const SurfaceSampler::Piece& piece : sampler.pieces()) cut += piece.visible != all_visible;
        StartBatch batch;
        const SobolSequence sequence(patch);
        sequence.points(0, batch.points);
        cosine_directions(batch.points[2], batch.points[3], batch.x.data(), batch.y.data(), batch.z.data());
        std::array<float, 80> x{}, y{}, z{}, dx{}, dy{}, dz{};
        std::array<std::uint32_t, 80> triangle{};
        starts.aim(batch, 5, 64, {x, y, z, dx, dy, dz, triangle}, 10);
        EXPECT_EQ(x[9], 0) << "nothing else is touched";
        EXPECT_EQ(x[69], 0);
        for (std::size_t k = 5; k < 64; ++k) {
            const std::size_t at = 10 + k - 5;
            const SurfacePoint one = sampler.point(batch.points[0][k], batch.points[1][k]);
            ++compared;
            if (triangle[at] != one.triangle) {
                ++elsewhere;
                continue;
            }
            const Vec3f extent = made->scene.corner_extent(one.triangle);
            const Vec3f origin = offset_origin(one.position, one.normal, extent);
            const Vec3f direction = Frame(one.normal).to_world({batch.x[k], batch.y[k], batch.z[k]});
            const Vec3f found(x[at], y[at], z[at]);
            // The rounding that the offset allows for, along the surface a little more than across it.
            EXPECT_LT((found - origin).length(), 4e-6f * std::max({extent.x, extent.y, extent.z}));
            EXPECT_LT(std::fabs((found - origin).dot(one.normal)), 0.5f * offset_distance(one.normal, extent))
                << "never behind the surface";
            EXPECT_EQ(Vec3f(dx[at], dy[at], dz[at]), direction);
        }
    }
    EXPECT_GT(flat, 100u);
    EXPECT_GT(cut, 10u);
    EXPECT_GT(made->patches.count() - flat, 20u) << "the ball";
    EXPECT_LE(elsewhere * 1000, compared) << "points on a border may round to its other side";
}

}  // namespace
}  // namespace luxel
