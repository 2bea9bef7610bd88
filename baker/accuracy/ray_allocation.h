/// Where the next rays help most.
///
/// The exchange area of a pair is known with the variance G_ij / (mu_i + mu_j), mu in rays/m2 (formfactors/closure.h), and an
/// error of it costs the light of all patches s_ij (sensitivity.h). The expected area-weighted squared error is
///     V = sum_pairs w_ij / (mu_i + mu_j) + sum_i w_i0 / mu_i,    w_ij = G_ij s_ij,    w_i0 = open_i s_i0.
/// It is convex in mu. The least V for a given number of rays, sum mu_i A_i, has
///     sum_j w_ij / (mu_i + mu_j)^2 + w_i0 / mu_i^2 = lambda A_i,
/// which the iteration mu_i *= sqrt(left_i / (lambda A_i)) finds. So lamps, which all others see, get many rays, and a
/// patch that sees nothing but even light gets few. Derived here.
///
/// The rays that decide are also rays that count: a patch that has found too little light by chance would get few more, and keep
/// believing it. So the patches of a neighbourhood share one density, for which left_i and A_i above become their sums:
/// what one of them has by chance is a small part of what all of them see.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "baker/accuracy/light_state.h"

namespace luxel {

/// Rays per patch, their sum `total_rays`, in the best proportion; every patch gets `floor_rays` at least.
/// `passes` over the matrix (6 are enough for powers of two). Threads: uses them all, the result does not depend on their number.
std::vector<double> best_rays(BlockSource& source, const LightState& light, double total_rays, double floor_rays,
                              std::uint32_t passes = 6);

}  // namespace luxel
