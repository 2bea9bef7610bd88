#include "baker/plan/open_rays.h"

#include "baker/core/parallel.h"
#include "baker/core/ray_offset.h"
#include "baker/core/sampling.h"
#include "baker/core/sobol.h"
#include "baker/patches/patch_sampler.h"

namespace luxel {
namespace {

constexpr std::uint64_t purpose = 0x6f70656e;  // separates these points from those of the evidence

}  // namespace

std::vector<std::uint32_t> count_open_rays(const BakedGeometry& g) {
    std::vector<std::uint32_t> open(g.patches.count());
    parallel_for(g.patches.count(), 64, [&](std::size_t p) {
        const auto patch = static_cast<PatchNumber>(p);
        const PatchSampler sampler(g.scene, g.atlas, g.patches, patch);
        const SobolSequence sequence(mix(g.patches.patches[p].id, purpose));
        for (std::uint32_t k = 0; k < open_rays_of_patch; ++k) {
            const auto u = sequence.point(k);
            const SurfacePoint at = sampler.point(u[0], u[1]);
            const TraceHit hit = g.tracer->first_hit({offset_origin(at.position, at.normal, g.scene.corner_extent(at.triangle)),
                                                      Frame(at.normal).to_world(cosine_direction(u[2], u[3])), at.triangle});
            open[p] += hit.triangle == none;
        }
    });
    return open;
}

}  // namespace luxel
