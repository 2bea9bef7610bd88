/// Mean of a light over the surface of each patch, by points that are stratified over the patch and over what lights it.
#pragma once
#include <cstdint>
#include <vector>

#include "baker/core/parallel.h"
#include "baker/core/sobol.h"
#include "baker/patches/patch_sampler.h"

namespace luxel {

/// Names of two sample patterns, so that they depend on nothing else that is sampled on patches.
struct PatchPurposes {
    std::uint64_t place, source;
};

/// light(point, of_place, of_source): irradiance at a point of the patch, lux; `of_place`, `of_source`: its points of the two patterns,
/// [0, 1)^4 (the first two of `of_place` chose the point). `points` per patch, a power of two. Threads: uses them all; a
/// pure function of geometry and stable ids if `light` is one.
template <class Light>
std::vector<Rgb> mean_over_patches(const Scene& scene, const Atlas& atlas, const PatchSet& patches, std::uint32_t points,
                                   const PatchPurposes& purposes, const Light& light) {
    std::vector<Rgb> means(patches.count());
    parallel_for(patches.count(), 16, [&](std::size_t p) {
        const PatchSampler sampler(scene, atlas, patches, static_cast<PatchNumber>(p));
        const PatchId id = patches.patches[p].id;
        const SobolSequence places(mix(id, purposes.place)), sources(mix(id, purposes.source));
        Rgb sum(0, 0, 0);
        for (std::uint32_t k = 0; k < points; ++k) {
            const auto u = places.point(k);
            sum += light(sampler.point(u[0], u[1]), u, sources.point(k));
        }
        means[p] = sum / static_cast<float>(points);
    });
    return means;
}

}  // namespace luxel
