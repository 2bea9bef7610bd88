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

void cosine_directions(std::span<const float> u, std::span<const float> v, float* __restrict x, float* __restrict y,
                       float* __restrict z) {
    for (std::size_t k = 0; k < u.size(); ++k) concentric(u[k], v[k], x[k], y[k], z[k]);
}

}  // namespace luxel
