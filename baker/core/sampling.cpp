#include "baker/core/sampling.h"

#include <cmath>

namespace luxel {
namespace {

/// One point of the concentric map lifted to the hemisphere; no branches, so that loops over it are vectorised.
inline void concentric(float u, float v, float& x, float& y, float& z) {
    const float a = 2 * u - 1, b = 2 * v - 1;
    const bool wide = std::fabs(a) > std::fabs(b);
    const float radius = wide ? a : b, other = wide ? b : a;
    const float ratio = radius != 0 ? other / radius : 0;
    // sin and cos of an angle in [-pi/4, pi/4]: Taylor terms up to the 9th power, error below one float step.
    const float angle = 0.785398163f * ratio, s = angle * angle;
    const float sine = angle * (1 - s * (1.0f / 6) * (1 - s * (1.0f / 20) * (1 - s * (1.0f / 42) * (1 - s * (1.0f / 72)))));
    const float cosine = 1 - s * (1.0f / 2) * (1 - s * (1.0f / 12) * (1 - s * (1.0f / 30) * (1 - s * (1.0f / 56))));
    x = radius * (wide ? cosine : sine);
    y = radius * (wide ? sine : cosine);
    // The rim would be tangent to the surface: keep z above zero.
    const float z2 = 1 - x * x - y * y;
    z = std::sqrt(z2 > 1e-12f ? z2 : 1e-12f);
}

}  // namespace

Vec3f cosine_direction(float u, float v) {
    Vec3f d;
    concentric(u, v, d.x, d.y, d.z);
    return d;
}

Vec2f cosine_square(const Vec3f& direction) {
    const float x = direction.x, y = direction.y;
    const bool wide = std::fabs(x) > std::fabs(y);
    const float longer = wide ? x : y, shorter = wide ? y : x;
    const float t = longer != 0 ? shorter / longer : 0;
    // arctan on [-1, 1]: half the angle twice, then three terms of its series; error below 1e-6.
    const float half = t / (1 + std::sqrt(1 + t * t)), quarter = half / (1 + std::sqrt(1 + half * half)), s = quarter * quarter;
    const float angle = 4 * quarter * (1 - s * (1.0f / 3 - s * (1.0f / 5 - s * (1.0f / 7))));
    const float radius = std::sqrt(x * x + y * y), signed_radius = longer < 0 ? -radius : radius;
    const float other = signed_radius * angle * (4 / 3.14159265358979f);
    const Vec2f square = wide ? Vec2f(signed_radius, other) : Vec2f(other, signed_radius);
    return (square + Vec2f(1, 1)) * 0.5f;
}

void cosine_directions(std::span<const float> u, std::span<const float> v, float* __restrict x, float* __restrict y,
                       float* __restrict z) {
    for (std::size_t k = 0; k < u.size(); ++k) concentric(u[k], v[k], x[k], y[k], z[k]);
}

}  // namespace luxel
