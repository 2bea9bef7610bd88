/// What some patches see of all others: how many pairs a bake will find, and how long its rays take.
#pragma once
#include "baker/bake/geometry_stages.h"

namespace luxel {

struct SightSample {
    double pairs = 0;            ///< expected, of all patches: each two that see each other counted once
    double index_bits = 0;       ///< per pair: log2 of how many patches of the same blocks there are for each that is met
    std::uint64_t rays_per_patch = 0;  ///< on average
    double seconds_per_ray = 0;  ///< of evidence, on all of the bake's threads if no other program runs
};

/// Casts `options.rays` evidence rays, or the hemicube, from each of 64 to 512 patches, spread evenly over the numbers. But for the time a pure function of
/// options and geometry. Threads: uses them all. Source: chance meetings are told from others by Good and Turing's estimate (Good, The
/// Population Frequencies of Species and the Estimation of Population Parameters, Biometrika 40, 1953).
SightSample sample_sight(const BakeOptions& options, const BakedGeometry& geometry);

}  // namespace luxel
