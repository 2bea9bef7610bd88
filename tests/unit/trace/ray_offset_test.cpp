/// The start of a ray lies on the side that it leaves to, exactly, and not far from the surface.
#include "baker/core/ray_offset.h"

#include <gtest/gtest.h>

#include "tests/unit/trace/made_rays.h"

namespace luxel {
namespace {

using test::RandomPoints;

TEST(RayOffset, LandsOnTheRightSideOfEveryTriangle) {
    RandomPoints random(1);
    for (const float scale : {1e-4f, 1.0f, 1e6f})
        for (const float far : {0.0f, 1.0f, 1000.0f})
            for (int round = 0; round < 5000; ++round) {
                Scene scene;
                const Vec3f shift = random.direction() * (far * scale);
                for (int k = 0; k < 3; ++k) scene.positions.push_back(shift + random.point(scale));
                scene.triangles.push_back({0, 1, 2});
                if (scene.area_m2(0) < 1e-4 * static_cast<double>(scale) * static_cast<double>(scale)) continue;
                const Vec3f point = surface_position(scene, 0, triangle_point(random.number(), random.number()));
                const Vec3f normal = scene.geometric_normal(0);
                const Vec3d exact_normal = scene.area_vector(0).normalized();
                for (const float side : {1.0f, -1.0f}) {
                    const Vec3f origin = offset_origin(point, normal * side, scene.corner_extent(0));
                    const double height = static_cast<double>(side) *
                                          (to_double(origin) - to_double(scene.corner(0, 0))).dot(exact_normal);
                    ASSERT_GT(height, 0) << "scale " << scale << ", far " << far;
                    ASSERT_LT(height, 1e-5 * static_cast<double>(scale) * static_cast<double>(1 + far));
                }
            }
}

TEST(RayOffset, MovesAlongAxes) {
    const Vec3f extent(1, 2, 3);
    EXPECT_GT(offset_origin({1, 2, 3}, {0, 1, 0}, extent).y, 2);
    EXPECT_LT(offset_origin({1, 2, 3}, {0, -1, 0}, extent).y, 2);
    EXPECT_EQ(offset_origin({1, 2, 3}, {0, 1, 0}, extent).x, 1);
    EXPECT_EQ(offset_origin({1, 2, 3}, {0, 1, 0}, extent).z, 3);
}

TEST(RayOffset, IsThatOfTheCornersNotOfThePoint) {
    const float floor_at_0 = offset_distance({0, 1, 0}, {100, 0, 100});
    EXPECT_GT(floor_at_0, 0) << "off the plane";
    EXPECT_LE(floor_at_0, 100 * 0x1p-24f) << "a floor at height 0 is exact";
    EXPECT_GT(offset_distance(Vec3f(0, 1, 1).normalized(), {100, 0, 100}), 4 * floor_at_0);
}

}  // namespace
}  // namespace luxel
