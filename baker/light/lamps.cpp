#include "baker/light/lamps.h"

#include <algorithm>
#include <cmath>

#include "baker/trace/ray_offset.h"

namespace luxel {
namespace {

/// Lamps that together give all but this share of the unshadowed light are tested one by one.
constexpr float weak_share = 0.1f;
/// Shadow rays for all the weak ones together.
constexpr int weak_samples = 2;

struct Contribution {
    float strength;
    std::uint32_t lamp;
    Rgb irradiance;
};

}  // namespace

Rgb unshadowed_irradiance(const Lamp& lamp, const Vec3f& position, const Vec3f& normal) {
    if (lamp.kind == LampKind::directional) return lamp.intensity * std::max(0.0f, -lamp.direction.dot(normal));
    const Vec3f to_lamp = lamp.position - position;
    const float d2 = to_lamp.dot(to_lamp);
    if (!(d2 > 0)) return {0, 0, 0};
    const float d = std::sqrt(d2);
    const float cosine = to_lamp.dot(normal) / d;
    if (cosine <= 0) return {0, 0, 0};
    float scale = cosine / d2;
    if (lamp.kind == LampKind::spot) {
        const float along = -lamp.direction.dot(to_lamp) / d;
        const float span = std::max(lamp.cos_inner - lamp.cos_outer, 1e-6f);
        const float edge = std::clamp((along - lamp.cos_outer) / span, 0.0f, 1.0f);
        scale *= edge * edge;
    }
    if (lamp.range > 0) {
        const float share = d / lamp.range;
        scale *= std::clamp(1 - share * share * share * share, 0.0f, 1.0f);
    }
    return lamp.intensity * scale;
}

Rgb LampLight::transmittance(const Lamp& lamp, const LightPoint& at) const {
    TraceRay ray;
    ray.origin = offset_origin(at.position, at.geometric_normal, scene_.corner_extent(at.triangle));
    ray.from_triangle = at.triangle;
    float distance = INFINITY;
    if (lamp.kind == LampKind::directional) {
        ray.direction = -lamp.direction;
    } else {
        const Vec3f to_lamp = lamp.position - ray.origin;
        distance = to_lamp.length();
        if (!(distance > 0)) return {1, 1, 1};
        ray.direction = to_lamp / distance;
    }
    // A lamp behind the surface itself cannot light it, whatever the shading normal says.
    if (ray.direction.dot(at.geometric_normal) <= 0) return {0, 0, 0};
    return tracer_.transmittance(ray, distance);
}

Rgb LampLight::arriving(const Rgb& light, const Lamp& lamp, const LightPoint& at) const {
    const Rgb share = transmittance(lamp, at);
    // In the dark nothing arrives, were the lamp so near that its light is not a number.
    const auto part = [&](int c) { return share[c] > 0 ? light[c] * share[c] : 0.0f; };
    return {part(0), part(1), part(2)};
}

Rgb LampLight::irradiance_of(std::uint32_t lamp, const LightPoint& at) const {
    const Rgb light = unshadowed_irradiance(scene_.lamps[lamp], at.position, at.shading_normal);
    return light != Rgb(0, 0, 0) ? arriving(light, scene_.lamps[lamp], at) : light;
}

Rgb LampLight::irradiance(const LightPoint& at, float random) const {
    std::vector<Contribution> candidates;
    float total = 0;
    for (std::uint32_t k = 0; k < scene_.lamps.size(); ++k) {
        const Rgb light = unshadowed_irradiance(scene_.lamps[k], at.position, at.shading_normal);
        const float strength = light.x + light.y + light.z;
        if (strength > 0) candidates.push_back({strength, k, light}), total += strength;
    }
    std::sort(candidates.begin(), candidates.end(), [](const Contribution& a, const Contribution& b) {
        return a.strength != b.strength ? a.strength > b.strength : a.lamp < b.lamp;
    });
    Rgb sum(0, 0, 0);
    std::size_t k = 0;
    float rest = total;
    for (; k < candidates.size() && rest > weak_share * total; ++k) {
        rest -= candidates[k].strength;
        sum += arriving(candidates[k].irradiance, scene_.lamps[candidates[k].lamp], at);
    }
    const std::size_t weak_begin = k;
    if (candidates.size() - weak_begin <= static_cast<std::size_t>(weak_samples)) {
        for (; k < candidates.size(); ++k)
            sum += arriving(candidates[k].irradiance, scene_.lamps[candidates[k].lamp], at);
        return sum;
    }
    float weak_total = 0;
    for (k = weak_begin; k < candidates.size(); ++k) weak_total += candidates[k].strength;
    // Systematic sampling: one random number, evenly spaced picks along the cumulative strengths.
    float cumulative = 0;
    int next = 0;
    for (k = weak_begin; k < candidates.size() && next < weak_samples; ++k) {
        cumulative += candidates[k].strength;
        int picks = 0;
        while (next < weak_samples &&
               (static_cast<float>(next) + random) * weak_total / weak_samples < cumulative) {
            ++picks;
            ++next;
        }
        if (picks)
            sum += arriving(candidates[k].irradiance, scene_.lamps[candidates[k].lamp], at) *
                   (static_cast<float>(picks) * weak_total / (weak_samples * candidates[k].strength));
    }
    return sum;
}

}  // namespace luxel
