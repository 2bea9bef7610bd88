/// Where a ray may start so that it neither meets its own surface nor skips a near one.
/// Source: the rounding bounds of Pharr, Jakob, Humphreys, Physically Based Rendering, 3rd ed., section 3.9: a point made
/// from barycentrics has an error of at most gamma(7) * sum |b_k p_k| per component; gamma(n) = n e / (1 - n e), e = 2^-24.
#pragma once
#include <algorithm>
#include <cmath>

#include "baker/core/vec.h"

namespace luxel {

/// Relative bound per component. Twice gamma(7), because the intersector computes with the same corners once more, and
/// one step for the sum below.
constexpr float position_error = (2 * 7 + 2) * 0x1p-24f;

/// How far a point of a triangle has to be moved along its unit normal to be on that side for certain, m. `extent`:
/// Scene::corner_extent of the triangle. Not of the point: near the origin a small number made of large ones has their
/// error. A plane through the origin along an axis has none; the last term keeps the start off the plane even there,
/// where triangles that continue it would be met at distance 0.
inline float offset_distance(const Vec3f& normal, const Vec3f& extent) {
    return position_error *
               (std::fabs(normal.x) * extent.x + std::fabs(normal.y) * extent.y + std::fabs(normal.z) * extent.z) +
           0x1p-24f * std::max({extent.x, extent.y, extent.z});
}

/// `point` moved along the unit normal (the side that the ray leaves to) by its error bound.
inline Vec3f offset_origin(const Vec3f& point, const Vec3f& normal, const Vec3f& extent) {
    return point + normal * offset_distance(normal, extent);
}

}  // namespace luxel
