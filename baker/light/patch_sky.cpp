#include "baker/light/patch_sky.h"

#include <cmath>

#include "baker/core/units.h"
#include "baker/light/patch_mean.h"
#include "baker/light/sky.h"
#include "baker/core/ray_offset.h"

namespace luxel {

Rgb binned_irradiance(std::span<const Rgb> bin_nits, std::span<const std::uint8_t> bins, std::span<const std::uint16_t> counts,
                      std::uint32_t rays) {
    std::array<double, 3> sum{};
    for (std::size_t k = 0; k < bins.size(); ++k)
        for (int c = 0; c < 3; ++c)
            sum[static_cast<std::size_t>(c)] += static_cast<double>(counts[k]) * static_cast<double>(bin_nits[bins[k]][c]);
    const double scale = pi / rays;
    return {static_cast<float>(scale * sum[0]), static_cast<float>(scale * sum[1]), static_cast<float>(scale * sum[2])};
}

void add_bright_sky(const Scene& scene, const Atlas& atlas, const PatchSet& patches, const Tracer& tracer, const SkyMap& bright,
                    std::uint32_t points, std::vector<Rgb>& irradiance) {
    if (bright.empty()) return;
    const Sky sky(bright);
    if (sky.is_dark()) return;
    constexpr PatchPurposes purposes{0x627269676874, 0x736b7961696d};
    const auto light = [&](const SurfacePoint& at, const std::array<float, 4>&, const std::array<float, 4>& w) {
        const Sky::Sample aim = sky.sample(w[0], w[1]);
        const float cosine = aim.direction.dot(at.normal);
        if (cosine <= 0 || !(aim.density > 0)) return Rgb(0, 0, 0);
        const TraceRay ray{offset_origin(at.position, at.normal, scene.corner_extent(at.triangle)), aim.direction, at.triangle};
        return tracer.transmittance(ray, INFINITY) * sky.radiance(aim.direction) * (cosine / aim.density);
    };
    const std::vector<Rgb> means = mean_over_patches(scene, atlas, patches, points, purposes, light);
    for (std::size_t p = 0; p < means.size(); ++p) irradiance[p] += means[p];
}

}  // namespace luxel
