#include "baker/light/patch_lamps.h"

#include "baker/core/parallel.h"
#include "baker/core/sobol.h"
#include "baker/light/surface_lamps.h"

namespace luxel {

std::vector<Rgb> patch_lamp_irradiance(const Scene& scene, const Atlas& atlas, const PatchSet& patches,
                                       const Tracer& tracer, std::uint32_t few_points, std::uint32_t points) {
    std::vector<Rgb> light(patches.count(), Rgb(0, 0, 0));
    if (scene.lamps.empty()) return light;
    const SurfaceLamps lamps(scene, tracer);
    parallel_for(patches.count(), 16, [&](std::size_t p) {
        const PatchSampler sampler(scene, atlas, patches, static_cast<PatchNumber>(p));
        light[p] = lamps.by_many({sampler, mix(patches.patches[p].id, 0x70617463686573), false}, few_points, points, 0);
    });
    return light;
}

}  // namespace luxel
