/// Form factors by ray casting: points uniform on the patch, directions cosine-distributed, so that the share of rays
/// that land on j estimates F_ij (Cohen and Wallace, Radiosity and Realistic Image Synthesis, 1993, section 4.5).
/// Where surfaces let light through, a ray counts whole or not at all: it meets each with the chance of its opacity, and survives the
/// colours of the panes that it passed by the mean of their channels, or counts as absorbed. So counts stay symmetric in
/// expectation, and the solve dims light between patches without colour; what is lost is put back afterwards (light/pane_colour.h).
/// Points of four-dimensional Owen-scrambled Sobol sequences (core/sobol.h), one independent scramble per replicate.
#pragma once
#include "baker/formfactors/estimator.h"
#include "baker/trace/tracer.h"
#include "baker/unwrap/atlas.h"

namespace luxel {

struct RayEstimatorOptions {
    std::uint64_t seed = 0;
    std::uint32_t replicates = 4;  ///< 1 to 255: independent scrambles, so that the error can be measured
};

/// References must outlive the estimator.
std::unique_ptr<Estimator> make_ray_estimator(const Scene& scene, const Atlas& atlas, const PatchSet& patches,
                                              const Tracer& tracer, const RayEstimatorOptions& options);

}  // namespace luxel
