#include "baker/light/patch_lamps.h"

#include "baker/core/parallel.h"
#include "baker/core/sobol.h"
#include "baker/patches/patch_sampler.h"

namespace luxel {

std::vector<Rgb> patch_lamp_irradiance(const Scene& scene, const Atlas& atlas, const PatchSet& patches,
                                       const Tracer& tracer, std::uint32_t points) {
    std::vector<Rgb> result(patches.count(), Rgb(0, 0, 0));
    const LampLight lamps(scene, tracer);
    if (lamps.empty()) return result;
    // Separates these points from those of the evidence, and points on the lamps from both.
    constexpr std::uint64_t purpose = 0x6c616d7073, lamp_purpose = 0x6f6e6c616d70;
    parallel_for(patches.count(), 16, [&](std::size_t p) {
        const PatchSampler sampler(scene, atlas, patches, static_cast<PatchNumber>(p));
        const SobolSequence sequence(mix(patches.patches[p].id, purpose)), on_lamps(mix(patches.patches[p].id, lamp_purpose));
        Rgb sum(0, 0, 0);
        for (std::uint32_t k = 0; k < points; ++k) {
            const auto u = sequence.point(k);
            const SurfacePoint at = sampler.point(u[0], u[1]);
            const auto on_lamp = on_lamps.point(k);
            sum += lamps.irradiance({at.position, at.normal, at.normal, at.triangle}, u[2], {on_lamp[0], on_lamp[1]});
        }
        result[p] = sum / static_cast<float>(points);
    });
    return result;
}

}  // namespace luxel
