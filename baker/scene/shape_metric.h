/// The shape of a mesh apart from where it stands: positions in a frame that is the same, bit for bit, for all copies that
/// differ by rotation, mirror image and place. What is computed from them (charts, hence patch ids) is then a function of
/// the mesh and its size alone, whichever other copies there are.
///
/// With rows x, y, z of the world matrix (p' = p M), lengths of p' are those of p under the metric G = M M^T. G is rounded to
/// 2^-16 of its largest entry, so that the rounding of rotations vanishes; p L with G = L L^T (Cholesky) has the same lengths
/// up to 1e-5. Pure functions.
#pragma once
#include <array>

#include "baker/core/vec.h"

namespace luxel {

/// G00, G10, G11, G20, G21, G22 in m2 per square unit of the mesh, rounded.
using ShapeMetric = std::array<double, 6>;

ShapeMetric shape_metric(const Vec3d& x, const Vec3d& y, const Vec3d& z);

/// The root L of a metric (lower triangle, same order); rows without a length of their own become zero.
std::array<double, 6> shape_root(const ShapeMetric& metric);

inline Vec3f shape_position(const std::array<double, 6>& root, const Vec3f& p) {
    const Vec3d d = to_double(p);
    return to_float({d.x * root[0] + d.y * root[1] + d.z * root[3], d.y * root[2] + d.z * root[4], d.z * root[5]});
}

}  // namespace luxel
