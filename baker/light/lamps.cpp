#include "baker/light/lamps.h"

#include <algorithm>
#include <cmath>

#include "baker/core/sampling.h"
#include "baker/core/units.h"
#include "baker/core/ray_offset.h"
#include "baker/light/lamp_beam.h"

namespace luxel {
namespace {

/// What cone and range leave of `scale` at the distance d (> 0) along `to_lamp`.
float beam(const Lamp& lamp, const Vec3f& to_lamp, float d, float scale) {
    return scale * cone_share(lamp, -lamp.direction.dot(to_lamp) / d) * range_share(lamp, d);
}

/// A sized lamp as a point sees it.
struct SizedView {
    Vec3f axis;            ///< unit, to its centre
    float distance = 0;    ///< of its centre; of no meaning for directional lamps
    float sine = 0;        ///< of half its apparent diameter; 1: the point is inside
    Rgb perpendicular;     ///< irradiance of a plane that faces it, or of any plane inside, lux
    [[nodiscard]] bool inside() const { return sine >= 1; }
};

bool is_sized(const Lamp& lamp) { return lamp.kind == LampKind::directional ? lamp.sin_radius > 0 : lamp.radius > 0; }

SizedView view_of(const Lamp& lamp, const Vec3f& position) {
    if (lamp.kind == LampKind::directional) return {-lamp.direction, INFINITY, lamp.sin_radius, lamp.intensity};
    const Vec3f to_lamp = lamp.position - position;
    const float d = to_lamp.length();
    const float scale = d > 0 ? beam(lamp, to_lamp, d, 1) : 1.0f;
    if (!(d > lamp.radius)) return {{0, 1, 0}, d, 1, lamp.intensity * (scale / (lamp.radius * lamp.radius))};
    return {to_lamp / d, d, std::min(lamp.radius / d, 0.999999f), lamp.intensity * (scale / (d * d))};
}

}  // namespace

float cone_form_factor(float cosine, float sine) {
    // In double: the two terms of a cone that the horizon cuts nearly cancel when it is narrow.
    const double c = static_cast<double>(cosine), s = static_cast<double>(sine);
    if (c >= s) return static_cast<float>(c * s * s);
    if (c <= -s) return 0;
    const double cotangent = std::sqrt(1 - s * s) / s;
    const double across = std::sqrt(std::max(0.0, 1 - c * c));
    const double cut = std::sqrt(std::max(0.0, 1 - c * c / (s * s)));
    const double inner = c * std::acos(std::clamp(-c * cotangent / across, -1.0, 1.0)) - cut * cotangent;
    return static_cast<float>(std::max(0.0, (inner * s * s + std::atan(cut / cotangent)) / pi));
}

Rgb unshadowed_irradiance(const Lamp& lamp, const Vec3f& position, const Vec3f& normal) {
    if (is_sized(lamp)) {
        const SizedView view = view_of(lamp, position);
        if (view.inside()) return view.perpendicular;
        return view.perpendicular * (cone_form_factor(view.axis.dot(normal), view.sine) / (view.sine * view.sine));
    }
    if (lamp.kind == LampKind::directional) return lamp.intensity * std::max(0.0f, -lamp.direction.dot(normal));
    const Vec3f to_lamp = lamp.position - position;
    const float d2 = to_lamp.dot(to_lamp), height = to_lamp.dot(normal);
    if (!(height > 0) || !(d2 > 0)) return {0, 0, 0};
    const float d = std::sqrt(d2);
    const float cosine = height / d;
    return lamp.intensity * beam(lamp, to_lamp, d, cosine / d2);
}

float spread_in_spot(const Lamp& lamp, const Vec3f& position, const Vec3f& normal, float spot_m) {
    if (lamp.kind == LampKind::directional) return 1;
    const Vec3f to_lamp = lamp.position - position;
    const float d = to_lamp.length(), height = to_lamp.dot(normal);
    // A sphere that the plane cuts is not what a point would be, but bounded.
    if (d >= spot_m || !(height > lamp.radius)) return 1;
    const float r = d / spot_m, h = height / spot_m;
    return 2 * r * r * (d / height) / (1 + h);
}

std::optional<TraceRay> LampLight::leave(const LightPoint& at, const Vec3f& direction) const {
    return leave_towards(scene_, tracer_, RayStart{at.position, at.geometric_normal, at.triangle, at.rise}, direction);
}

Rgb LampLight::transmittance(const Lamp& lamp, const LightPoint& at) const {
    Vec3f direction = -lamp.direction;
    if (lamp.kind != LampKind::directional) {
        const Vec3f start = offset_origin(at.position, at.geometric_normal, scene_.corner_extent(at.triangle));
        direction = lamp.position - start;
        const float distance = direction.length();
        if (!(distance > 0)) return {1, 1, 1};
        direction /= distance;
    }
    // A lamp behind the surface itself cannot light it, whatever the shading normal says.
    std::optional<TraceRay> ray = leave(at, direction);
    if (!ray) return {0, 0, 0};
    float distance = INFINITY;
    if (lamp.kind != LampKind::directional) {
        const Vec3f to_lamp = lamp.position - ray->origin;
        distance = to_lamp.length();
        if (!(distance > 0)) return {1, 1, 1};
        ray->direction = to_lamp / distance;
    }
    return tracer_.transmittance(*ray, distance);
}

Rgb LampLight::arriving(const Rgb& light, const Lamp& lamp, const LightPoint& at) const {
    const Rgb share = transmittance(lamp, at);
    // In the dark nothing arrives, were the lamp so near that its light is not a number.
    const auto part = [&](int c) { return share[c] > 0 ? light[c] * share[c] : 0.0f; };
    return {part(0), part(1), part(2)};
}

/// Directions over the lamp with a density that goes with their cosine against its axis, so that a plane which faces the
/// lamp gets the same from each. Inside: over the point's own hemisphere.
Rgb LampLight::sized(const Lamp& lamp, const LightPoint& at, const Vec2f& on_lamp) const {
    const SizedView view = view_of(lamp, at.position);
    const Frame frame(view.inside() ? at.shading_normal : view.axis);
    Rgb sum(0, 0, 0);
    static_assert(size_samples == 4);
    for (int k = 0; k < size_samples; ++k) {
        // One point in each quarter of the square.
        Vec3f local = cosine_direction(0.5f * (static_cast<float>(k & 1) + on_lamp.x), 0.5f * (static_cast<float>(k >> 1) + on_lamp.y));
        local.x *= view.sine, local.y *= view.sine;
        local.z = std::sqrt(std::max(1e-12f, 1 - local.x * local.x - local.y * local.y));
        const Vec3f direction = frame.to_world(local).normalized();
        const float cosine = direction.dot(at.shading_normal);
        if (cosine <= 0) continue;
        const std::optional<TraceRay> ray = leave(at, direction);
        if (!ray) continue;
        float distance = INFINITY;
        if (lamp.kind != LampKind::directional) {
            const Vec3f to_lamp = lamp.position - at.position;
            const float along = to_lamp.dot(direction);
            const float half_chord = std::sqrt(std::max(0.0f, lamp.radius * lamp.radius - (to_lamp - direction * along).length2()));
            distance = view.inside() ? along + half_chord : along - half_chord;
        }
        sum += tracer_.transmittance(*ray, distance) * (view.inside() ? 1.0f : cosine / local.z);
    }
    return view.perpendicular * sum / static_cast<float>(size_samples);
}

Rgb LampLight::shadowed(const Lamp& lamp, const Rgb& unshadowed, const LightPoint& at, const Vec2f& on_lamp) const {
    if (is_sized(lamp)) return sized(lamp, at, on_lamp);
    return arriving(unshadowed, lamp, at);
}

Rgb LampLight::irradiance_of(std::uint32_t lamp, const LightPoint& at, const Vec2f& on_lamp) const {
    const Rgb light = unshadowed_irradiance(scene_.lamps[lamp], at.position, at.shading_normal);
    return light != Rgb(0, 0, 0) ? shadowed(scene_.lamps[lamp], light, at, on_lamp) : Rgb(0, 0, 0);
}

Rgb LampLight::irradiance(const LightPoint& at, float random, const Vec2f& on_lamp) const {
    const RankedLamps lamps = rank_lamps(lamp_strengths(scene_.lamps, at.position, 0, &at.shading_normal));
    return strong_irradiance(lamps, at, on_lamp) + weak_irradiance(lamps, at, random, on_lamp);
}

Rgb LampLight::strong_irradiance(const RankedLamps& lamps, const LightPoint& at, const Vec2f& on_lamp) const {
    Rgb sum(0, 0, 0);
    for (const std::uint32_t lamp : lamps.strong) sum += irradiance_of(lamp, at, on_lamp);
    return sum;
}

Rgb LampLight::weak_irradiance(const RankedLamps& lamps, const LightPoint& at, float random, const Vec2f& on_lamp) const {
    Rgb sum(0, 0, 0);
    if (lamps.weak.empty()) return sum;
    for (int k = 0; k < RankedLamps::weak_choices; ++k) {  // evenly spaced along the cumulative strengths
        const LampTable::Choice choice = lamps.weak.choose((static_cast<float>(k) + random) / RankedLamps::weak_choices);
        sum += irradiance_of(choice.lamp, at, on_lamp) / choice.probability;
    }
    return sum / RankedLamps::weak_choices;
}

}  // namespace luxel
