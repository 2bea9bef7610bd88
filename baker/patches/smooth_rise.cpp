#include "baker/patches/smooth_rise.h"

#include "baker/patches/fragment_polygon.h"
#include "baker/patches/patch_sampler.h"

namespace luxel {
namespace {

/// To the triangle's own normal.
constexpr float widest_cosine = 0.70710678f;

}  // namespace

Vec3f smooth_rise(const Scene& scene, std::uint32_t triangle, const Vec2f& barycentric) {
    const auto& corners = scene.triangles[triangle];
    const Vec3f geometric = scene.geometric_normal(triangle);
    float least = 1;
    for (std::size_t k = 0; k < 3; ++k) least = std::min(least, scene.corner_normal(triangle, k).dot(geometric));
    if (least >= flat_cosine || least < widest_cosine) return {0, 0, 0};
    const Vec3f position = surface_position(scene, triangle, barycentric);
    const float weights[] = {1 - barycentric.x - barycentric.y, barycentric.x, barycentric.y};
    Vec3f rise(0, 0, 0);
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec3f normal = scene.corner_normal(triangle, k);
        const float below_m = (scene.positions[corners[k]] - position).dot(normal);
        if (below_m > 0) rise += normal * (weights[k] * below_m);
    }
    return rise.dot(geometric) > 0 ? rise : Vec3f(0, 0, 0);
}

}  // namespace luxel
