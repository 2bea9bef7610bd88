/// Triangles and rays at random, for the tests of this room.
#pragma once
#include <random>

#include "baker/core/sampling.h"
#include "baker/patches/fragment_polygon.h"
#include "baker/trace/tracer.h"
#include "tests/support/scenes.h"

namespace luxel::test {

class RandomPoints {
  public:
    explicit RandomPoints(unsigned seed) : random_(seed) {}
    float number(float low = 0, float high = 1) { return std::uniform_real_distribution<float>(low, high)(random_); }
    std::uint32_t below(std::size_t count) { return static_cast<std::uint32_t>(random_() % count); }
    Vec3f point(float half) { return {number(-half, half), number(-half, half), number(-half, half)}; }
    Vec3f direction() {
        for (;;) {
            const Vec3f p = point(1);
            if (p.length2() > 0.01f && p.length2() <= 1) return p.normalized();
        }
    }

  private:
    std::mt19937_64 random_;
};

/// Loose triangles of very different sizes.
inline MadeMesh soup(std::size_t count, RandomPoints& random) {
    MadeMesh mesh;
    for (std::uint32_t t = 0; t < count; ++t) {
        const Vec3f center = random.point(5);
        const float size = std::exp2(random.number(-6, 2));
        for (int k = 0; k < 3; ++k) mesh.positions.push_back(center + random.point(size));
        mesh.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
    }
    return mesh;
}

/// The position that a hit names, by its barycentrics.
inline Vec3f position_of(const Scene& scene, const TraceHit& hit) {
    return surface_position(scene, hit.triangle, {hit.b1, hit.b2});
}

}  // namespace luxel::test
