/// Maps from the unit square to the things that rays need. No libm: sine and cosine differ in the last bit between
/// machines, polynomials do not.
#pragma once
#include <span>

#include "baker/core/vec.h"

namespace luxel {

/// Cosine-distributed direction in the local frame (z up), density cos(theta)/pi per sr. z > 0.
/// Source: Shirley and Chiu, A Low Distortion Map Between Disk and Square, JGT 2(3) 1997; Malley's method.
Vec3f cosine_direction(float u, float v);

/// The same for arrays: x[k], y[k], z[k] from u[k], v[k], bit for bit as cosine_direction.
void cosine_directions(std::span<const float> u, std::span<const float> v, float* x, float* y, float* z);

/// The point (u, v) of the unit square from which cosine_direction() makes a unit direction, z >= 0; to about 1e-6.
Vec2f cosine_square(const Vec3f& direction);

/// Uniform barycentrics (weights of corners 1 and 2) of a triangle; keeps strata compact.
/// Source: Heitz, A Low-Distortion Map Between Triangle and Square, 2019.
inline Vec2f triangle_point(float u, float v) {
    const bool upper = v > u;
    const float half = 0.5f * (upper ? u : v);
    return upper ? Vec2f(half, v - half) : Vec2f(u - half, half);
}

}  // namespace luxel
