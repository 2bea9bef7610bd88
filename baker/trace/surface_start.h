/// Where rays leave a point of the surface that is given by its triangle.
#pragma once
#include "baker/patches/fragment_polygon.h"
#include "baker/core/ray_offset.h"

namespace luxel {

/// The point with these weights of corners 1 and 2, moved to the side of the unit `normal` by its error bound; m.
/// Threads: a pure function. Errors: none.
inline Vec3f surface_start(const Scene& scene, std::uint32_t triangle, const Vec2f& barycentric, const Vec3f& normal) {
    return offset_origin(surface_position(scene, triangle, barycentric), normal, scene.corner_extent(triangle));
}

}  // namespace luxel
