#include "baker/formfactors/sky_view.h"

#include <array>

#include "baker/core/parallel.h"
#include "baker/core/sampling.h"
#include "baker/core/sobol.h"
#include "baker/patches/patch_sampler.h"
#include "baker/core/ray_offset.h"

namespace luxel {
namespace {

using BinCounts = std::array<std::uint16_t, sky_bin_count>;

BinCounts count_rays(const Scene& scene, const PatchSampler& sampler, const Tracer& tracer, std::uint64_t seed,
                     std::uint32_t ray_count) {
    constexpr std::uint32_t batch = SobolSequence::batch;
    const SobolSequence sequence(seed);
    BinCounts counts{};
    std::array<std::array<float, batch>, 4> u;
    std::array<TraceRay, batch> rays;
    std::array<TraceHit, batch> hits;
    for (std::uint32_t begin = 0; begin < ray_count; begin += batch) {
        const std::uint32_t size = std::min(batch, ray_count - begin);
        sequence.points(begin, u);
        for (std::uint32_t k = 0; k < size; ++k) {
            const SurfacePoint at = sampler.point(u[0][k], u[1][k]);
            rays[k] = {offset_origin(at.position, at.normal, scene.corner_extent(at.triangle)),
                       Frame(at.normal).to_world(cosine_direction(u[2][k], u[3][k])), at.triangle};
        }
        tracer.first_hits(std::span(rays).first(size), std::span(hits).first(size));
        for (std::uint32_t k = 0; k < size; ++k)
            if (hits[k].triangle == none) ++counts[sky_bin(rays[k].direction)];
    }
    return counts;
}

}  // namespace

SkyCounts count_sky_rays(const Scene& scene, const Atlas& atlas, const PatchSet& patches, const Tracer& tracer,
                         PatchNumber begin, PatchNumber end, const SkyViewOptions& options) {
    constexpr std::uint64_t purpose = 0x736b79;  // separates these rays from those of the evidence
    std::vector<BinCounts> counts(end - begin);
    parallel_for(counts.size(), 8, [&](std::size_t k) {
        const auto patch = static_cast<PatchNumber>(begin + k);
        const PatchSampler sampler(scene, atlas, patches, patch);
        counts[k] = count_rays(scene, sampler, tracer, mix(mix(patches.patches[patch].id, options.seed), purpose), options.rays);
    });
    SkyCounts result;
    for (const BinCounts& of_patch : counts) {
        const std::size_t first = result.bins.size();
        for (std::uint32_t bin = 0; bin < sky_bin_count; ++bin)
            if (of_patch[bin]) {
                result.bins.push_back(static_cast<SkyBin>(bin));
                result.counts.push_back(of_patch[bin]);
            }
        result.bins_of_patch.push_back(static_cast<std::uint16_t>(result.bins.size() - first));
    }
    return result;
}

}  // namespace luxel
