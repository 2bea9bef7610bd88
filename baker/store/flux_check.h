/// The self-check of the sampler: what a patch sends to the others by its own rays is what it gets from them by theirs.
///
/// By reciprocity A_i F_ij = A_j F_ji, so for every patch i the two sums
///     out_i = A_i sum_j n_ij / N_i,     in_i = sum_j A_j n_ji / N_j        (j != i, both with rays of their own), m2
/// estimate the same exchange area with different rays. A sampler that is wrong anywhere (directions, places on the patch,
/// normals, the map from hit to patch) makes them differ; a right one never does, whatever the scene.
///
/// Two tests on the differences d_i = out_i - in_i, from R replicates d_i^r that are independent of each other:
///   all patches  off-diagonal part of the Gram matrix K_rs = sum_i w_i d_i^r d_i^s, w_i = 1 / Poisson variance: its mean over
///                r != s is an unbiased estimate of sum_i w_i E[d_i]^2, zero for a right sampler, however much less than
///                Poisson the low-discrepancy points scatter. Finds a small error in many patches.
///   each patch   t_i = d_i / s_i, where s_i^2 from R replicates is drawn towards the Poisson variance times the scatter's
///                usual share of it (moderated t: Smyth, Linear models and empirical Bayes methods, Stat. Appl. Genet. Mol.
///                Biol. 3(1), 2004, section 4 and 6). Smallest probability times number of patches (Bonferroni). Finds a
///                large error in few patches.
/// A difference up to `allowance` of the patch's area is no finding: areas of patches are known to about that only.
/// Estimators without independent replicates (hemicube) cannot be checked this way.
#pragma once
#include <span>
#include <vector>

#include "baker/store/evidence_reader.h"

namespace luxel {

struct FluxInput {
    std::span<const PatchId> ids;          ///< per patch number
    std::span<const double> area_m2;       ///< > 0
    std::span<const std::uint32_t> rays;   ///< N_i over all rounds and replicates
};

struct FluxOptions {
    double false_alarm = 1e-3;     ///< probability that a right sampler fails
    double allowance = 1e-3;       ///< of the patch's area
    double least_rays = 64;        ///< patches that see others by fewer rays, or are to be seen by fewer, are left out
    std::size_t worst = 10;        ///< patches to list
};

struct FluxSuspect {
    PatchNumber patch = 0;
    PatchId id = 0;
    double out_m2 = 0, in_m2 = 0, standard_error_m2 = 0;
    double t = 0;  ///< (out - in, less the allowance) / standard error
};

struct FluxCheck {
    std::uint64_t patches = 0;     ///< tested
    std::uint64_t skipped = 0;     ///< too few rays
    std::uint32_t replicates = 0;
    double mean_difference = 0;    ///< sum |out - in| / sum (out + in) / 2
    double scatter = 0;            ///< variance over replicates as a share of the Poisson variance
    double freedom = 0;            ///< degrees of freedom of t
    double probability_all = 1;    ///< of a result like this or worse from a right sampler, first test
    double probability_each = 1;   ///< the same, second test
    bool passed = true;            ///< smaller of the two, doubled, is not below false_alarm
    std::vector<FluxSuspect> worst;  ///< largest |t| first
};

/// One sequential pass. Memory: 8 (R + 4) bytes per patch. Threads: uses them all; the result does not depend on their number.
/// Throws Error{damaged_store} for damaged evidence or more replicates in one record than in the first.
FluxCheck check_flux(const FluxInput& input, std::span<const EvidenceFile> files, const FluxOptions& options = {},
                     const ProgressFunction& progress = {});

}  // namespace luxel
