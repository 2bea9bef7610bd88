/// First hits and visibility against brute force in double precision, and the rules for ties.
#include "baker/trace/tracer.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "baker/core/parallel.h"
#include "baker/trace/coincident.h"
#include "tests/support/scenes.h"
#include "tests/unit/trace/made_rays.h"

namespace luxel {
namespace {

using test::add_quad;
using test::MadeMesh;
using test::quad;
using test::RandomPoints;
using test::SceneMaker;

bool operator==(const TraceHit& a, const TraceHit& b) {
    return a.triangle == b.triangle && a.b1 == b.b1 && a.b2 == b.b2 && a.distance_m == b.distance_m &&
           a.front == b.front;
}

std::vector<TraceRay> random_rays(std::size_t count, RandomPoints& random, std::size_t triangles) {
    std::vector<TraceRay> rays(count);
    for (TraceRay& ray : rays) {
        ray = {random.point(6), random.direction(), none};
        if (random.below(2)) ray.from_triangle = random.below(triangles);
    }
    return rays;
}

TEST(Tracer, BatchEqualsSingle) {
    flush_denormals();
    RandomPoints random(1);
    const Scene scene = SceneMaker().add("soup", test::soup(500, random)).build();
    const Tracer tracer(scene);
    for (const std::size_t count : {0u, 1u, 7u, 8u, 9u, 64u, 20000u}) {
        const auto rays = random_rays(count, random, scene.triangle_count());
        std::vector<TraceHit> hits(count);
        tracer.first_hits(rays, hits);
        for (std::size_t k = 0; k < count; ++k) ASSERT_TRUE(hits[k] == tracer.first_hit(rays[k])) << "ray " << k;
    }
}

TEST(Tracer, AnyPartOfRayColumns) {
    flush_denormals();
    RandomPoints random(2);
    const Scene scene = SceneMaker().add("soup", test::soup(500, random)).build();
    const Tracer tracer(scene);
    const auto rays = random_rays(RayColumns::capacity, random, scene.triangle_count());
    RayColumns columns;
    for (std::size_t k = 0; k < rays.size(); ++k) columns.set(k, rays[k]);
    for (std::size_t begin = 0; begin <= rays.size(); begin += 3)
        for (std::size_t end = begin; end <= rays.size(); ++end) {
            for (const RayCoherence coherence : {RayCoherence::apart, RayCoherence::together}) {
                std::vector<TraceHit> hits(end - begin);
                tracer.first_hits(columns, begin, hits, coherence);
                for (std::size_t k = begin; k < end; ++k) ASSERT_TRUE(hits[k - begin] == tracer.first_hit(rays[k])) << "ray " << k;
            }
        }
}

struct Met {
    double distance = INFINITY;
    std::uint32_t triangle = none;
    bool front = false;
};

/// Source: Moeller and Trumbore, Fast, Minimum Storage Ray/Triangle Intersection, 1997; in double.
Met brute_force(const Scene& scene, const TraceRay& ray) {
    Met nearest;
    const Vec3d origin = to_double(ray.origin), direction = to_double(ray.direction);
    for (std::uint32_t t = 0; t < scene.triangle_count(); ++t) {
        if (t == ray.from_triangle) continue;
        const Vec3d a = to_double(scene.corner(t, 0));
        const Vec3d u = to_double(scene.corner(t, 1)) - a, v = to_double(scene.corner(t, 2)) - a;
        const Vec3d p = direction.cross(v), s = origin - a, q = s.cross(u);
        const double det = u.dot(p), b1 = s.dot(p) / det, b2 = direction.dot(q) / det, at = v.dot(q) / det;
        if (b1 >= 0 && b2 >= 0 && b1 + b2 <= 1 && at > 0 && at < nearest.distance) nearest = {at, t, det > 0};
    }
    return nearest;
}

TEST(Tracer, AgreesWithBruteForce) {
    flush_denormals();
    RandomPoints random(2);
    const Scene scene = SceneMaker().add("soup", test::soup(300, random)).build();
    const Tracer tracer(scene);
    std::size_t different = 0, met = 0;
    for (const TraceRay& ray : random_rays(20000, random, scene.triangle_count())) {
        const TraceHit hit = tracer.first_hit(ray);
        const Met expected = brute_force(scene, ray);
        met += expected.triangle != none;
        if (hit.triangle != expected.triangle) {
            ++different;  // an edge grazed within the rounding of floats
            continue;
        }
        if (hit.triangle == none) continue;
        EXPECT_EQ(hit.front, expected.front);
        EXPECT_NEAR(hit.distance_m, expected.distance, 1e-4);
        EXPECT_NEAR((test::position_of(scene, hit) - (ray.origin + ray.direction * hit.distance_m)).length(), 0, 1e-3);
    }
    EXPECT_LE(different, 4u);
    EXPECT_GT(met, 5000u);
}

/// Rays along -z and +z onto copies of one quad in the plane z = 0; `order` lists which copies face up.
std::array<TraceHit, 2> onto_copies(const std::vector<bool>& faces_up, bool other_corner_order = false) {
    SceneMaker maker;
    int number = 0;
    for (const bool up : faces_up) {
        MadeMesh mesh = quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0});
        if (!up) mesh = test::turned(mesh);
        if (other_corner_order && number % 2)
            for (auto& triangle : mesh.triangles) std::rotate(triangle.begin(), triangle.begin() + 1, triangle.end());
        maker.add(std::to_string(number++), mesh);
    }
    const Scene scene = maker.build();
    const Tracer tracer(scene);
    std::array<TraceHit, 2> hits{tracer.first_hit({Vec3f(0.4f, 0.1f, 3) - to_float(scene.origin), {0, 0, -1}, none}),
                                 tracer.first_hit({Vec3f(0.4f, 0.1f, -3) - to_float(scene.origin), {0, 0, 1}, none})};
    for (TraceHit& hit : hits) {
        const Vec3f at = test::position_of(scene, hit) + to_float(scene.origin);
        EXPECT_NEAR((at - Vec3f(0.4f, 0.1f, 0)).length(), 0, 1e-5)
            << "the barycentrics belong to the triangle that is named";
        EXPECT_NEAR(hit.distance_m, 3, 1e-5);
        hit.triangle = scene.triangle_object[hit.triangle];
    }
    return hits;
}

TEST(Tracer, CoincidentTrianglesFrontFirstThenLowest) {
    for (const bool other_order : {false, true}) {
        const auto same = onto_copies({true, true, true}, other_order);
        EXPECT_EQ(same[0].triangle, 0u);
        EXPECT_TRUE(same[0].front);
        EXPECT_EQ(same[1].triangle, 0u);
        EXPECT_FALSE(same[1].front);
        const auto mixed = onto_copies({false, true, true, false}, other_order);
        EXPECT_EQ(mixed[0].triangle, 1u);
        EXPECT_TRUE(mixed[0].front);
        EXPECT_EQ(mixed[1].triangle, 0u);
        EXPECT_TRUE(mixed[1].front);
    }
}

TEST(Tracer, CoincidenceIsExact) {
    const MadeMesh low = quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0});
    const Scene scene = SceneMaker().add("a", low).add("b", test::moved(low, {0, 0, 1e-3f})).add("c", low).build();
    const CoincidentTriangles coincident(scene);
    for (std::uint32_t t = 0; t < scene.triangle_count(); ++t) {
        const auto group = coincident.group(t);
        const bool alone = scene.triangle_object[t] == 1;
        EXPECT_EQ(group.size(), alone ? 0u : 2u);
        if (!alone) {
            EXPECT_EQ(group[1] - group[0], 4u);
        }
    }
    EXPECT_TRUE(CoincidentTriangles(SceneMaker().add("a", low).build()).empty());
}

TEST(Tracer, OwnTriangleIsSkipped) {
    SceneMaker maker;
    for (int k = 0; k < 3; ++k) {
        MadeMesh mesh;
        mesh.positions = {
            {-1, -1, -static_cast<float>(k)}, {3, -1, -static_cast<float>(k)}, {-1, 3, -static_cast<float>(k)}};
        mesh.triangles = {{0, 1, 2}};
        maker.add(std::to_string(k), mesh);
    }
    const Scene scene = maker.build();
    const Tracer tracer(scene);
    const Vec3f above = Vec3f(0, 0, 1) - to_float(scene.origin);
    for (std::uint32_t own = 0; own < 3; ++own) {
        const TraceRay ray{above, {0, 0, -1}, own};
        std::array<TraceHit, 1> batch;
        tracer.first_hits({&ray, 1}, batch);
        EXPECT_EQ(tracer.first_hit(ray).triangle, own == 0 ? 1u : 0u);
        EXPECT_EQ(batch[0].triangle, own == 0 ? 1u : 0u);
    }
}

/// A start exactly in a plane through the origin: the hit at 0 must neither be reported nor be met for ever.
TEST(Tracer, StartsInTheOwnPlaneAtZero) {
    flush_denormals();
    Scene scene = SceneMaker().add("a", quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0})).build();
    const Tracer tracer(scene);
    ASSERT_EQ(scene.origin.z, 0);
    for (const Vec3f& direction : {Vec3f(0, 0, 1), Vec3f(0, 0, -1), Vec3f(0.6f, 0, 0.8f), Vec3f(0.8f, 0.6f, 1e-20f)})
        for (std::uint32_t own = 0; own < 2; ++own) {
            const TraceRay ray{own == 0 ? Vec3f(0.5f, -0.5f, 0) : Vec3f(-0.5f, 0.5f, 0), direction, own};
            EXPECT_NE(tracer.first_hit(ray).triangle, own);
        }
}

/// A ray that starts in the plane of its own triangle meets it at distance 0, where denormals are no way out.
TEST(Tracer, OwnTriangleAtDistanceZeroIsSkipped) {
    flush_denormals();
    const Scene scene = SceneMaker()
                            .add("floor", quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}))
                            .add("top", quad({-1, 1, -1}, {2, 0, 0}, {0, 0, 2}))
                            .build();
    const Tracer tracer(scene);
    for (std::uint32_t own = 0; own < 2; ++own) {
        const Vec3f middle = (scene.corner(own, 0) + scene.corner(own, 1) + scene.corner(own, 2)) / 3;
        const TraceHit hit = tracer.first_hit({middle, Vec3f(0.1f, 1, 0.2f).normalized(), own});
        ASSERT_NE(hit.triangle, none);
        EXPECT_EQ(scene.triangle_object[hit.triangle], 1u);
    }
}

/// The copy of a triangle is another triangle, whichever of the two the tree names first.
TEST(Tracer, OwnTriangleIsSkippedAmongCoincidentOnes) {
    MadeMesh mesh;
    mesh.positions = {{-1, -1, 0}, {3, -1, 0}, {-1, 3, 0}};
    mesh.triangles = {{0, 1, 2}};
    const Scene scene = SceneMaker().add("a", mesh).add("b", test::turned(mesh)).add("c", mesh).build();
    const Tracer tracer(scene);
    for (std::uint32_t own = 0; own < 3; ++own) {
        const TraceRay ray{Vec3f(0, 0, 1) - to_float(scene.origin), {0, 0, -1}, own};
        const TraceHit hit = tracer.first_hit(ray);
        EXPECT_EQ(hit.triangle, own == 0 ? 2u : 0u);
        EXPECT_TRUE(hit.front);
        std::array<TraceHit, 1> batch;
        tracer.first_hits({&ray, 1}, batch);
        EXPECT_TRUE(batch[0] == hit);
    }
}

/// Other objects give another tree; what a ray meets is the same, down to the last bit. (Rays aimed at an edge may find
/// both of its triangles at one distance, and then the tree decides; rays at random do not.)
TEST(Tracer, OtherObjectsChangeNothing) {
    flush_denormals();
    const auto room = [](bool more) {
        Scene scene;  // made directly: its origin does not follow the objects
        if (more) test::add_object(scene, "more", test::moved(test::icosphere(3, 1), {20, 3, -7}), 1);
        test::add_object(scene, "walls", test::room({0, 0, 0}, {3, 2.5f, 3}), 2);
        test::add_object(scene, "ball", test::moved(test::icosphere(3, 0.5f), {1, 1, 1}), 3);
        test::add_object(scene, "box", test::moved(test::box(0.5f, 0.7f, 0.6f), {2, 0.5f, 2}), 4);
        if (more) test::add_object(scene, "even more", test::moved(test::box(5, 5, 5), {-9, 0, 0}), 5);
        return scene;
    };
    const Scene plain = room(false), crowded = room(true);
    const Tracer a(plain), b(crowded);
    const std::uint32_t shift = crowded.objects[1].first_triangle;
    RandomPoints random(9);
    std::size_t different = 0;
    for (int k = 0; k < 1'000'000; ++k) {
        const Vec3f origin(random.number(0.05f, 2.95f), random.number(0.05f, 2.45f), random.number(0.05f, 2.95f));
        const TraceRay ray{origin, random.direction(), none};
        TraceHit first = a.first_hit(ray);
        first.triangle += shift;
        different += !(first == b.first_hit(ray));
    }
    EXPECT_EQ(different, 0u);
}

TEST(Tracer, OccludedBetweenOpenEnds) {
    const Scene scene = SceneMaker().add("a", quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0})).build();
    const Tracer tracer(scene);
    for (const float side : {1.0f, -1.0f}) {
        const TraceRay ray{Vec3f(0.3f, 0.2f, side) - to_float(scene.origin), {0, 0, -side}, none};
        EXPECT_FALSE(tracer.occluded(ray, 0.5f));
        EXPECT_FALSE(tracer.occluded(ray, 1.0f)) << "the far end lies on the surface";
        EXPECT_TRUE(tracer.occluded(ray, 1.001f));
        EXPECT_TRUE(tracer.occluded(ray, INFINITY));
        EXPECT_FALSE(tracer.occluded({ray.origin, -ray.direction, none}, INFINITY));
    }
    EXPECT_FALSE(tracer.occluded({Vec3f(3, 0, 1), {0, 0, -1}, none}, INFINITY));
}

TEST(Tracer, EmptySceneIsOpen) {
    const Scene scene;
    const Tracer tracer(scene);
    EXPECT_EQ(tracer.first_hit({{0, 0, 0}, {0, 0, 1}, none}).triangle, none);
    EXPECT_FALSE(tracer.occluded({{0, 0, 0}, {0, 0, 1}, none}, INFINITY));
}

TEST(Tracer, CountsItsBytes) {
    RandomPoints random(5);
    const Scene scene = SceneMaker().add("soup", test::soup(1000, random)).build();
    const Tracer tracer(scene);
    EXPECT_GT(tracer.resident_bytes(), scene.positions.size() * sizeof(Vec3f));
    EXPECT_LT(tracer.resident_bytes(), 10'000'000u);
}

/// Embree may limit the threads of the whole process to those that it builds the tree with: one.
TEST(Tracer, LeavesTheThreadsToOthers) {
    if (std::thread::hardware_concurrency() < 2) GTEST_SKIP() << "one processor";
    const ThreadLimit limit(2);
    const auto two_threads_meet = [] {
        std::atomic<int> here = 0, met = 0;
        parallel_for(2, 1, [&](std::size_t) {
            ++here;
            // Each waits for the other: only two threads can meet.
            const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(5);
            while (here < 2 && std::chrono::steady_clock::now() < until) std::this_thread::yield();
            if (here == 2) ++met;
        });
        return met == 2;
    };
    const Scene scene = test::SceneMaker().add("walls", test::room({0, 0, 0}, {1, 1, 1})).build();
    auto first = std::make_unique<Tracer>(scene);
    EXPECT_TRUE(two_threads_meet());
    const Tracer second(scene);
    EXPECT_TRUE(two_threads_meet());
    first.reset();
    EXPECT_TRUE(two_threads_meet());
}

}  // namespace
}  // namespace luxel
