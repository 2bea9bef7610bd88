/// Where a ray may start so that it neither meets its own surface nor skips a near one.
/// Source: the rounding bounds of Pharr, Jakob, Humphreys, Physically Based Rendering, 3rd ed., section 3.9: a point made
/// from barycentrics has an error of at most gamma(7) * sum |b_k p_k| per component; gamma(n) = n e / (1 - n e), e = 2^-24.
#pragma once
#include <algorithm>
#include <cmath>

#include "baker/core/vec.h"

namespace luxel {

/// Bound of the rounding error of a point whose corners have coordinates of at most `extent` (m), per component.
/// Twice gamma(7), because the intersector computes with the same corners once more, and one step for the sum below.
inline float position_error(float extent) { return (2 * 7 + 2) * 0x1p-24f * extent; }

/// `point` moved along the unit normal (the side that the ray leaves to) by its error bound.
inline Vec3f offset_origin(const Vec3f& point, const Vec3f& normal) {
    // The bound in the direction of the normal: sum of |n_k| * error_k.
    const float extent = std::max({std::fabs(point.x), std::fabs(point.y), std::fabs(point.z)});
    return point + normal * (position_error(extent) * (std::fabs(normal.x) + std::fabs(normal.y) + std::fabs(normal.z)));
}

}  // namespace luxel
