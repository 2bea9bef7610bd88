/// Rays that graze a smooth mesh start above it, unless something is in the way; all others start as ever.
#include "baker/trace/smooth_start.h"

#include <gtest/gtest.h>

#include "baker/patches/smooth_rise.h"
#include "baker/core/ray_offset.h"
#include "tests/support/scenes.h"

namespace luxel {
namespace {

/// A ridge along z: two slopes of 0.1 that meet at x = 0, with normals of a hump (bend = 1) or straight up (0).
Scene ridge(float bend) {
    Scene scene;
    test::MadeMesh mesh;
    test::add_quad(mesh, {-1, 0, -1}, {0, 0, 2}, {1, 0.1f, 0});
    test::add_quad(mesh, {0, 0.1f, -1}, {0, 0, 2}, {1, -0.1f, 0});
    test::add_object(scene, "ridge", mesh, 1);
    for (std::size_t v = 0; v < scene.normals.size(); ++v) scene.normals[v] = Vec3f(bend * 0.2f * scene.positions[v].x, 1, 0).normalized();
    return scene;
}

SurfacePoint middle(const Scene& scene, std::uint32_t triangle) {
    const Vec2f b(0.3f, 0.3f);
    return {surface_position(scene, triangle, b), scene.geometric_normal(triangle), triangle, b};
}

void expect_plain(const Scene& scene, const TraceRay& ray, const SurfacePoint& at) {
    EXPECT_EQ(ray.origin, offset_origin(at.position, at.normal, scene.corner_extent(at.triangle)));
    EXPECT_EQ(ray.from_triangle, at.triangle);
}

TEST(SmoothRise, OnlyWhereNormalsBendOutwards) {
    const Scene hump = ridge(1);
    for (std::uint32_t t = 0; t < hump.triangle_count(); ++t) {
        const Vec3f rise = smooth_rise(hump, t, {0.3f, 0.3f});
        EXPECT_GT(rise.dot(hump.geometric_normal(t)), 0.01f);
        EXPECT_LT(rise.length(), 0.2f);
        for (const Vec2f& corner : {Vec2f(0, 0), Vec2f(1, 0), Vec2f(0, 1)}) EXPECT_LT(smooth_rise(hump, t, corner).length(), 1e-6f);
    }
    Scene hollow;
    test::add_object(hollow, "inside", test::turned(test::uv_sphere(12, 8, 1)), 1);
    for (std::size_t v = 0; v < hollow.normals.size(); ++v) hollow.normals[v] = -hollow.positions[v];
    for (std::uint32_t t = 0; t < hollow.triangle_count(); ++t) EXPECT_EQ(smooth_rise(hollow, t, {0.3f, 0.3f}), Vec3f(0, 0, 0));
}

TEST(SmoothRise, NoneOnFlatTrianglesAndOnRoundedBoxes) {
    Scene flat;
    test::add_object(flat, "flat", test::quad({10.1f, -3.3f, 0.7f}, {0.1f, 0.9f, 7}, {5, 0.3f, 0.2f}), 1);
    for (const std::uint32_t t : {0u, 1u}) EXPECT_EQ(smooth_rise(flat, t, {0.2f, 0.7f}), Vec3f(0, 0, 0));
    Scene box;
    test::MadeMesh mesh = test::box(1, 1, 1);
    test::add_object(box, "box", mesh, 1);
    for (std::size_t v = 0; v < box.normals.size(); ++v) box.normals[v] = (box.positions[v] - Vec3f(0.5f, 0.5f, 0.5f)).normalized();
    for (std::uint32_t t = 0; t < box.triangle_count(); ++t) EXPECT_EQ(smooth_rise(box, t, {0.2f, 0.3f}), Vec3f(0, 0, 0));
}

/// An edge between two triangles of a hump: both sides rise alike.
TEST(SmoothRise, IsContinuousAcrossSmoothEdges) {
    const Scene hump = ridge(1);
    // Triangles 0 and 1 share the edge from corner 0 to corner 2 of the first.
    for (const float share : {0.1f, 0.5f, 0.8f}) {
        const Vec3f a = smooth_rise(hump, 0, {0, share}), b = smooth_rise(hump, 1, {share, 0});
        EXPECT_LT((a - b).length(), 1e-6f) << share;
        EXPECT_GT(a.length(), 1e-3f);
    }
}

TEST(SmoothStart, OnlyGrazingRaysAreMoved) {
    const Scene scene = ridge(1);
    const Tracer tracer(scene);
    const SurfacePoint at = middle(scene, 0);
    const Vec3f rise = smooth_rise(scene, 0, at.barycentric);
    for (const Vec3f& high : {Vec3f(0, 1, 0), Vec3f(0.7f, 0.5f, 0.3f).normalized(), Vec3f(-1, 0.05f, 0).normalized()})
        expect_plain(scene, leave_towards(scene, tracer, at, high).value(), at);
    // Downhill on the other side of the crest: below the triangle, above the horizon of the smooth surface.
    const Vec3f below = Vec3f(1, 0.05f, 0).normalized();
    ASSERT_LT(below.dot(at.normal), 0);
    const auto ray = leave_towards(scene, tracer, at, below);
    ASSERT_TRUE(ray);
    EXPECT_LT((ray->origin - at.position - rise).length(), 1e-5f);
    EXPECT_EQ(ray->from_triangle, none);
    // In between the move fades out, without a step.
    const Vec3f half = (at.normal * 0.05f + Vec3f(0, 0, 1)).normalized();
    EXPECT_LT((leave_towards(scene, tracer, at, half)->origin - at.position - rise * 0.5f).length(), 1e-3f);
}

TEST(SmoothStart, NothingLiesBelowFlatTriangles) {
    const Scene scene = ridge(0);  // leans, but all corners alike
    const Tracer tracer(scene);
    SurfacePoint at = middle(scene, 0);
    EXPECT_FALSE(leave_towards(scene, tracer, RayStart{at.position, at.normal, at.triangle}, -at.normal));
    const Vec3f along(0, 0, 1);
    EXPECT_FALSE(leave_towards(scene, tracer, RayStart{at.position, at.normal, at.triangle}, (along - at.normal * 0.01f).normalized()));
    expect_plain(scene, leave_towards(scene, tracer, RayStart{at.position, at.normal, at.triangle}, (along + at.normal * 0.01f).normalized()).value(), at);
}

/// A sheet closer to the surface than the move: no ray may start behind it.
TEST(SmoothStart, NothingNearIsPassed) {
    Scene scene = ridge(1);
    const SurfacePoint at = middle(scene, 0);
    const Vec3f rise = smooth_rise(scene, 0, at.barycentric);
    const float height = 0.5f * rise.length();
    test::add_object(scene, "sheet", test::quad({-1, at.position.y + height, -1}, {0, 0, 2}, {2, 0, 0}), 2);
    const Tracer tracer(scene);
    const Vec3f low = (at.normal * 0.01f + Vec3f(0, 0, 1)).normalized();
    expect_plain(scene, leave_towards(scene, tracer, at, low).value(), at);
    EXPECT_FALSE(leave_towards(scene, tracer, at, Vec3f(1, 0.05f, 0).normalized()));
}

/// The back of a hump is a hollow, and its rise is no start for rays that leave there.
TEST(SmoothStart, BacksStartOnTheTriangle) {
    const Scene scene = ridge(1);
    const Tracer tracer(scene);
    SurfacePoint at = middle(scene, 0);
    at.normal = -at.normal;
    const Vec3f low = (at.normal * 0.01f + Vec3f(0, 0, 1)).normalized();
    expect_plain(scene, leave_towards(scene, tracer, at, low).value(), at);
}

}  // namespace
}  // namespace luxel
