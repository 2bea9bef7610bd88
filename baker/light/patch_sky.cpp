#include "baker/light/patch_sky.h"

#include <cmath>

#include "baker/core/parallel.h"
#include "baker/core/ray_offset.h"
#include "baker/core/sobol.h"
#include "baker/core/units.h"
#include "baker/light/sky.h"
#include "baker/patches/patch_sampler.h"

namespace luxel {
namespace {

/// Names of the sample patterns.
constexpr std::uint64_t place_purpose = 0x627269676874, aim_purpose = 0x736b7961696d;

}  // namespace

Rgb binned_irradiance(std::span<const Rgb> bin_nits, std::span<const SkyBin> bins, std::span<const std::uint16_t> counts,
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
    const auto light_at = [&](const SurfacePoint& at, const std::array<float, 4>& aim_at) {
        const Sky::Sample aim = sky.sample(aim_at[0], aim_at[1]);
        const float cosine = aim.direction.dot(at.normal);
        if (cosine <= 0 || !(aim.density > 0)) return Rgb(0, 0, 0);
        const TraceRay ray{offset_origin(at.position, at.normal, scene.corner_extent(at.triangle)), aim.direction, at.triangle};
        return tracer.transmittance(ray, INFINITY) * sky.radiance(aim.direction) * (cosine / aim.density);
    };
    parallel_for(patches.count(), 16, [&](std::size_t p) {
        const PatchSampler sampler(scene, atlas, patches, static_cast<PatchNumber>(p));
        const PatchId id = patches.patches[p].id;
        const SobolSequence places(mix(id, place_purpose));
        const ShuffledSobol aims(mix(id, aim_purpose));
        Rgb sum(0, 0, 0);
        for (std::uint32_t k = 0; k < points; ++k) {
            const auto u = places.point(k);
            sum += light_at(sampler.point(u[0], u[1]), aims.point(k));
        }
        irradiance[p] += sum / static_cast<float>(points);
    });
}

}  // namespace luxel
