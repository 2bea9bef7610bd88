/// Direct light of KHR_lights_punctual lamps at a point. Panes on the way take their colour from it (Tracer::transmittance).
///
/// point, spot   E = I cos(theta) / d^2; spot times clamp((cos a - cos outer) / (cos inner - cos outer), 0, 1)^2;
///               with a range: times clamp(1 - (d / range)^4, 0, 1). directional: E = lux * cos(theta).
/// Source        the extension's text (falloff and range windows as recommended there).
#pragma once
#include <cstdint>
#include <vector>

#include "baker/scene/scene.h"
#include "baker/trace/tracer.h"

namespace luxel {

struct LightPoint {
    Vec3f position;          ///< on the surface
    Vec3f geometric_normal;  ///< unit: shadow rays leave to this side
    Vec3f shading_normal;    ///< unit: the cosine is taken against it
    std::uint32_t triangle = none;
};

/// Irradiance of one lamp without shadows, lux.
Rgb unshadowed_irradiance(const Lamp& lamp, const Vec3f& position, const Vec3f& normal);

class LampLight {
  public:
    /// References must outlive it.
    LampLight(const Scene& scene, const Tracer& tracer) : scene_(scene), tracer_(tracer) {}
    [[nodiscard]] bool empty() const { return scene_.lamps.empty(); }
    /// Irradiance of all lamps, lux. The strongest lamps get a shadow ray each; of the many weak ones a few are chosen in
    /// proportion to what they would give, so that the mean over `random` in [0, 1) is exact.
    [[nodiscard]] Rgb irradiance(const LightPoint& at, float random) const;
    /// Of one lamp, with its shadow, lux. `lamp`: index into Scene::lamps.
    [[nodiscard]] Rgb irradiance_of(std::uint32_t lamp, const LightPoint& at) const;

  private:
    /// What is left of `light` of a lamp after all that stands between.
    [[nodiscard]] Rgb arriving(const Rgb& light, const Lamp& lamp, const LightPoint& at) const;
    /// 0..1 per channel.
    [[nodiscard]] Rgb transmittance(const Lamp& lamp, const LightPoint& at) const;
    const Scene& scene_;
    const Tracer& tracer_;
};

}  // namespace luxel
