/// Direct light of KHR_lights_punctual lamps at a point. Panes on the way take their colour from it (Tracer::transmittance).
///
/// point, spot   E = I cos(theta) / d^2; spot times clamp((cos a - cos outer) / max(cos inner - cos outer, 0.001), 0, 1)^2;
///               with a range: times clamp(1 - (d / range)^4, 0, 1). directional: E = lux * cos(theta).
/// sized         a point or spot lamp with a radius R is a sphere of luminance I / (pi R^2): from far away, or while it is
///               wholly above the horizon of the point, it gives what a point would. Cone and range are those of its
///               centre: size softens shadows, not the beam. A directional lamp with an apparent diameter is a disk of even
///               luminance on the sky. Inside its sphere a lamp is all around: E = I / R^2.
/// Source        the extension's text (falloff and range windows as recommended there); spheres: Lambert's projected solid
///               angle of a cone, cut by the horizon as in Snyder, Area Light Sources for Real-Time Graphics, 1996.
#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "baker/light/lamp_table.h"
#include "baker/scene/scene.h"
#include "baker/trace/smooth_start.h"

namespace luxel {

struct LightPoint {
    Vec3f position;          ///< on the surface
    Vec3f geometric_normal;  ///< unit: shadow rays leave to this side
    Vec3f shading_normal;    ///< unit: the cosine is taken against it
    std::uint32_t triangle = none;
    Vec3f rise{0, 0, 0};  ///< smooth_rise() where the shading normal is the smooth surface's, m: shadow rays that graze start there
};

/// Irradiance of one lamp without shadows, lux.
Rgb unshadowed_irradiance(const Lamp& lamp, const Vec3f& position, const Vec3f& normal);

/// What to multiply the irradiance of a lamp by to spread it evenly over the spot that it makes on a surface nearby: where that lies within `spot_m`
/// of the lamp; 1 elsewhere. Seen from afar nothing changes but that no point of the spot is brighter than its mean.
/// A plane at height h cuts the ball of radius R around the lamp in a disc of pi (R^2 - h^2), which gets I 2 pi (1 - h / R): E = 2 I / (R (R + h)).
/// `normal`: unit, of the plane.
float spread_in_spot(const Lamp& lamp, const Vec3f& position, const Vec3f& normal, float spot_m);

/// Share of a plane's cosine-weighted hemisphere that a cone of directions covers: a sphere of relative radius `sine` < 1
/// (radius over distance) whose centre is at `cosine` from the plane's normal.
float cone_form_factor(float cosine, float sine);

class LampLight {
  public:
    /// Shadow rays to each sized lamp that is tested.
    static constexpr int size_samples = 4;

    /// References must outlive it.
    LampLight(const Scene& scene, const Tracer& tracer) : scene_(scene), tracer_(tracer) {}
    [[nodiscard]] bool empty() const { return scene_.lamps.empty(); }
    /// Irradiance of all lamps, lux. The strongest lamps get a shadow ray each, sized ones size_samples; of the many weak ones
    /// a few are chosen in proportion to what they would give. The mean over `random` in [0, 1) and `on_lamp` in the unit
    /// square is exact.
    [[nodiscard]] Rgb irradiance(const LightPoint& at, float random, const Vec2f& on_lamp) const;
    /// Its two parts, of lamps that were ranked for points around this one.
    [[nodiscard]] Rgb strong_irradiance(const RankedLamps& lamps, const LightPoint& at, const Vec2f& on_lamp) const;
    [[nodiscard]] Rgb weak_irradiance(const RankedLamps& lamps, const LightPoint& at, float random, const Vec2f& on_lamp) const;
    /// Of one lamp, with its shadow, lux; the mean over `on_lamp` is exact. `lamp`: index into Scene::lamps.
    [[nodiscard]] Rgb irradiance_of(std::uint32_t lamp, const LightPoint& at, const Vec2f& on_lamp) const;

  private:
    [[nodiscard]] Rgb shadowed(const Lamp& lamp, const Rgb& unshadowed, const LightPoint& at, const Vec2f& on_lamp) const;
    [[nodiscard]] Rgb sized(const Lamp& lamp, const LightPoint& at, const Vec2f& on_lamp) const;
    /// What is left of `light` of a lamp after all that stands between.
    [[nodiscard]] Rgb arriving(const Rgb& light, const Lamp& lamp, const LightPoint& at) const;
    /// Nothing if the direction leads into the object.
    [[nodiscard]] std::optional<TraceRay> leave(const LightPoint& at, const Vec3f& direction) const;
    /// 0..1 per channel.
    [[nodiscard]] Rgb transmittance(const Lamp& lamp, const LightPoint& at) const;
    const Scene& scene_;
    const Tracer& tracer_;
};

}  // namespace luxel
