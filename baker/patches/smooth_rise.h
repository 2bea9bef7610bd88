/// How far the smooth surface that the shading normals tell of lies above a flat triangle. Light that grazes a coarse round
/// mesh is cut off at the flat triangles' edges, while the shading goes on smoothly: dark polygons along the terminator.
/// Rays that start on the smooth surface (trace/smooth_start.h) pass the mesh as they would pass what it stands for.
///
/// The point is projected onto the tangent plane of each corner that it lies below; the rise is the mean of these moves by
/// its barycentrics. So it is 0 at corners, the same on both sides of a smooth edge, and about twice the distance to the arc
/// between the corners: rays above the horizon of the shading normal then clear a round mesh.
///
/// 0 where the normals are the triangle's own (flat shading), where one leans over by more than 45 degrees (a box with
/// round normals: it says nothing about a surface), and where the move would not lead outwards (hollow surface).
/// Units: m. Threads: a pure function. Errors: none.
/// Source: Hanika, Hacking the Shadow Terminator, Ray Tracing Gems II, 2021, chapter 4.
#pragma once
#include "baker/scene/scene.h"

namespace luxel {

/// From the point with these weights of corners 1 and 2, on the front of the triangle.
Vec3f smooth_rise(const Scene& scene, std::uint32_t triangle, const Vec2f& barycentric);

}  // namespace luxel
