#include "baker/core/sampling.h"

#include <cmath>

namespace luxel {
namespace {

/// sin and cos of a in [-pi/4, pi/4]; Taylor terms up to a^9, error below 3e-9.
void sin_cos_eighth(float a, float& sine, float& cosine) {
    const double x = a, s = x * x;
    sine = static_cast<float>(x * (1 - s / 6 * (1 - s / 20 * (1 - s / 42 * (1 - s / 72)))));
    cosine = static_cast<float>(1 - s / 2 * (1 - s / 12 * (1 - s / 30 * (1 - s / 56))));
}

}  // namespace

Vec3f cosine_direction(float u, float v) {
    const float a = 2 * u - 1, b = 2 * v - 1;
    float x = 0, y = 0;
    if (a != 0 || b != 0) {
        constexpr float quarter_pi = 0.785398163f;
        float sine, cosine;
        if (std::fabs(a) > std::fabs(b)) {
            sin_cos_eighth(quarter_pi * (b / a), sine, cosine);
            x = a * cosine, y = a * sine;
        } else {
            sin_cos_eighth(quarter_pi * (a / b), sine, cosine);
            x = b * sine, y = b * cosine;
        }
    }
    // The rim would be tangent to the surface: keep z above zero.
    const float z2 = 1 - x * x - y * y;
    return {x, y, std::sqrt(z2 > 1e-12f ? z2 : 1e-12f)};
}

Vec2f triangle_point(float u, float v) {
    if (v > u) {
        u *= 0.5f;
        v -= u;
    } else {
        v *= 0.5f;
        u -= v;
    }
    return {u, v};
}

}  // namespace luxel
