#include "baker/trace/open_backs.h"

#include <array>

#include "baker/core/parallel.h"
#include "baker/core/sampling.h"
#include "baker/core/sobol.h"
#include "baker/patches/patch_sampler.h"
#include "baker/core/ray_offset.h"

namespace luxel {
namespace {

constexpr std::size_t probe_rays = 32;
constexpr std::uint64_t purpose = 0x6261636b;  // separates these points from those of the evidence

bool back_is_open(const Scene& scene, const Atlas& atlas, const PatchSet& patches, PatchNumber patch,
                  const Tracer& tracer) {
    const SurfaceSampler sampler(scene, atlas, patches.fragments_of(patch), true);
    const SobolSequence sequence(mix(patches.patches[patch].id, purpose));
    std::array<TraceRay, probe_rays> rays;
    std::array<TraceHit, probe_rays> hits;
    for (std::size_t k = 0; k < probe_rays; ++k) {
        const auto u = sequence.point(static_cast<std::uint32_t>(k));
        const SurfacePoint at = sampler.point(u[0], u[1]);
        rays[k] = {offset_origin(at.position, at.normal, scene.corner_extent(at.triangle)), Frame(at.normal).to_world(cosine_direction(u[2], u[3])),
                   at.triangle};
    }
    tracer.first_hits(rays, hits);
    std::size_t fronts = 0, open = 0;
    for (const TraceHit& hit : hits) {
        open += hit.triangle == none;
        fronts += hit.triangle != none && hit.front;
    }
    return fronts > 0 || (open > 0 && open < probe_rays);
}

bool is_two_sided(const Scene& scene, const PatchSet& patches, PatchNumber patch) {
    return scene.object_of(patches.fragments_of(patch).front().triangle).double_sided;
}

}  // namespace

std::vector<bool> find_open_backs(const Scene& scene, const Atlas& atlas, const PatchSet& patches, const Tracer& tracer) {
    std::vector<std::uint8_t> open(patches.count());  // bytes: threads write neighbours
    parallel_for(patches.count(), 64, [&](std::size_t p) {
        const auto patch = static_cast<PatchNumber>(p);
        open[p] = is_two_sided(scene, patches, patch) && back_is_open(scene, atlas, patches, patch, tracer);
    });
    return {open.begin(), open.end()};
}

std::vector<bool> find_all_backs(const Scene& scene, const PatchSet& patches) {
    std::vector<bool> backs(patches.count());
    for (PatchNumber p = 0; p < backs.size(); ++p) backs[p] = is_two_sided(scene, patches, p);
    return backs;
}

}  // namespace luxel
