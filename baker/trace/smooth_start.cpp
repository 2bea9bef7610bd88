#include "baker/trace/smooth_start.h"

#include <algorithm>

#include "baker/patches/smooth_rise.h"
#include "baker/core/ray_offset.h"

namespace luxel {
namespace {

/// Sine of the angle above the triangle from which on rays start on it.
constexpr float grazing_sine = 0.1f;

}  // namespace

std::optional<TraceRay> leave_towards(const Scene& scene, const Tracer& tracer, const RayStart& from, const Vec3f& direction) {
    TraceRay ray{offset_origin(from.position, from.normal, scene.corner_extent(from.triangle)), direction, from.triangle};
    const float above = direction.dot(from.normal);
    if (above < grazing_sine && from.rise != Vec3f(0, 0, 0)) {
        const Vec3f move = from.rise * std::min(1.0f, 1 - above / grazing_sine);
        const float length = move.length();
        if (length > 0 && !tracer.occluded({ray.origin, move / length, from.triangle}, length))
            return TraceRay{ray.origin + move, direction, none};
    }
    if (above <= 0) return std::nullopt;
    return ray;
}

std::optional<TraceRay> leave_towards(const Scene& scene, const Tracer& tracer, const SurfacePoint& from, const Vec3f& direction) {
    RayStart start{from.position, from.normal, from.triangle};
    if (direction.dot(from.normal) < grazing_sine) start.rise = smooth_rise(scene, from.triangle, from.barycentric);
    if (start.rise.dot(from.normal) <= 0) start.rise = {0, 0, 0};  // that of the other side
    return leave_towards(scene, tracer, start, direction);
}

}  // namespace luxel
