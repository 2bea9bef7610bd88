/// Rays from the walls of a closed room never escape and never meet the back of a wall, whatever the room's size, place
/// and slant. Edges and corners are aimed at on purpose.
#include <gtest/gtest.h>

#include "baker/core/parallel.h"
#include "baker/core/ray_offset.h"
#include "tests/unit/trace/made_rays.h"

namespace luxel {
namespace {

using test::MadeMesh;
using test::RandomPoints;
using test::SceneMaker;

struct Tally {
    std::size_t escaped = 0, back = 0;
};

/// Where a ray starts: on a triangle, seen from its front.
struct Start {
    std::uint32_t triangle;
    Vec3f position, normal;
};

Start random_start(const Scene& scene, RandomPoints& random) {
    const std::uint32_t t = random.below(scene.triangle_count());
    const Vec2f b = triangle_point(random.number(), random.number());
    return {t, surface_position(scene, t, b), scene.geometric_normal(t)};
}

/// Leaves `rays` empty.
Tally trace(const Tracer& tracer, std::vector<TraceRay>& rays) {
    std::vector<TraceHit> hits(rays.size());
    tracer.first_hits(rays, hits);
    Tally tally;
    for (const TraceHit& hit : hits) {
        tally.escaped += hit.triangle == none;
        tally.back += hit.triangle != none && !hit.front;
    }
    rays.clear();
    return tally;
}

/// Cosine-distributed, grazing, and aimed at corners and at points of edges.
Tally from_walls(const Scene& scene, std::size_t count, unsigned seed) {
    flush_denormals();
    const Tracer tracer(scene);
    RandomPoints random(seed);
    std::vector<TraceRay> rays;
    Tally sum;
    for (std::size_t k = 0; k < count; ++k) {
        const Start start = random_start(scene, random);
        Vec3f direction;
        if (k % 4 == 0) {
            const std::uint32_t t = random.below(scene.triangle_count());
            const float share = random.below(3) ? random.number() : 0;
            direction = scene.corner(t, 0) * (1 - share) + scene.corner(t, 1) * share - start.position;
            direction.normalize();
            if (!(direction.dot(start.normal) > 1e-3f)) continue;
        } else {
            Vec3f local = cosine_direction(random.number(), random.number());
            if (k % 4 == 1) local.z *= 1e-3f;
            direction = Frame(start.normal).to_world(local).normalized();
        }
        rays.push_back({offset_origin(start.position, start.normal, scene.corner_extent(start.triangle)), direction,
                        start.triangle});
        if (rays.size() < 4096 && k + 1 < count) continue;
        const Tally part = trace(tracer, rays);
        sum.escaped += part.escaped;
        sum.back += part.back;
    }
    return sum;
}

Scene room_of(MadeMesh mesh, float scale, const Vec3f& shift) {
    Scene scene = SceneMaker().add("room", mesh).build();
    for (Vec3f& p : scene.positions) p = p * scale + shift;
    return scene;
}

TEST(Watertight, AMillionRaysInASphere) {
    const Scene scene = room_of(test::turned(test::icosphere(3, 1)), 1, Vec3f(0));
    const Tally tally = from_walls(scene, 1'000'000, 1);
    EXPECT_EQ(tally.escaped, 0u);
    EXPECT_EQ(tally.back, 0u);
}

TEST(Watertight, RoomsOfAllSizesAndPlaces) {
    struct Case {
        float scale;
        Vec3f shift;
    };
    for (const Case& c : {Case{1e-4f, Vec3f(0)}, Case{1e6f, Vec3f(0)}, Case{1, {1000, -2000, 500}},
                          Case{1e-4f, {1, 1, 1}}, Case{1e6f, {1e7f, 0, 0}}}) {
        const Scene sphere = room_of(test::turned(test::icosphere(2, 1)), c.scale, c.shift);
        const Scene box = room_of(test::room({-1, -1, -1}, {1, 1, 1}), c.scale, c.shift);
        for (const Scene* scene : {&sphere, &box}) {
            const Tally tally = from_walls(*scene, 50'000, 2);
            EXPECT_EQ(tally.escaped, 0u) << c.scale << " at " << c.shift.x;
            // A start that rounding puts behind the wall beside it meets that wall's back: the share of such points is
            // that of the rounding in the room's size.
            const float rounding = c.shift.length() * 0x1p-23f / c.scale;
            EXPECT_LE(static_cast<float>(tally.back), 50'000 * rounding) << c.scale << " at " << c.shift.x;
        }
    }
}

/// Large triangles that pass close to the origin: points near it are small numbers made of large ones, so their error
/// is that of the corners.
TEST(Watertight, SlantedWallsThroughTheOrigin) {
    RandomPoints random(3);
    for (int round = 0; round < 20; ++round) {
        MadeMesh mesh = test::room({-50, 0, -50}, {50, 40, 50});
        const Frame turn(random.direction());
        for (Vec3f& p : mesh.positions) p = turn.to_world(p);
        const Scene scene = room_of(mesh, 1, Vec3f(0));
        const Tally tally = from_walls(scene, 20'000, static_cast<unsigned>(round));
        EXPECT_EQ(tally.escaped, 0u) << round;
        EXPECT_EQ(tally.back, 0u) << round;
    }
}

/// The same near the origin alone: starts within centimetres of it, where an error bound of the point itself is
/// nothing, on both sides of the line that two triangles of the floor share.
TEST(Watertight, StartsNearTheOrigin) {
    flush_denormals();
    RandomPoints random(4);
    std::size_t starts = 0, escaped = 0, back = 0, occluded = 0;
    for (int round = 0; round < 200; ++round) {
        MadeMesh mesh = test::room({-50, 0, -50}, {50, 40, 50});
        const Frame turn(random.direction());
        for (Vec3f& p : mesh.positions) p = turn.to_world(p);
        const Scene scene = room_of(mesh, 1, to_float(SceneMaker().add("room", mesh).build().origin));
        const Tracer tracer(scene);
        for (std::uint32_t t = 0; t < scene.triangle_count(); ++t)
            for (int k = 0; k < 50; ++k) {
                const float along = random.number(0.4999f, 0.5001f), away = random.number(0, 1e-5f);
                for (const Vec2f& b :
                     {Vec2f(along - away, away), Vec2f(away, along - away), Vec2f(along - away, 1 - along)}) {
                    const Vec3f position = surface_position(scene, t, b), normal = scene.geometric_normal(t);
                    if (position.length() > 0.02f) continue;
                    ++starts;
                    Vec3f local = cosine_direction(random.number(), random.number());
                    local.z *= 1e-4f;
                    const TraceRay ray{offset_origin(position, normal, scene.corner_extent(t)),
                                       Frame(normal).to_world(local).normalized(), t};
                    if (ray.direction.dot(normal) <= 0) continue;
                    const TraceHit hit = tracer.first_hit(ray);
                    escaped += hit.triangle == none;
                    back += hit.triangle != none && !hit.front;
                    occluded += tracer.occluded({ray.origin, normal, t}, 10);
                }
            }
    }
    EXPECT_GT(starts, 5000u);
    EXPECT_EQ(escaped, 0u);
    EXPECT_EQ(back, 0u);
    EXPECT_EQ(occluded, 0u) << "a surface shadows itself";
}

}  // namespace
}  // namespace luxel
