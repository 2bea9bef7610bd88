/// How errors of the light gathered by each patch spread through further bounces, for several error patterns at once.
#pragma once
#include "baker/accuracy/pattern_solve.h"

namespace luxel {

/// `noise_lm`: wrong light arriving at each patch, A_i dH_i, lm, per pattern. Returns the irradiance error dH of each patch
/// with all bounces, lm/m2, in one channel: dH_i = (noise_i + sum_j G_ij rho_j dH_j) / A_i. An estimate of an error need not be
/// exact: `tolerance` as in solve_patterns(). Deterministic for any number of threads.
Patterns propagate_errors(BlockSource& source, const LightState& light, std::size_t channel, const Patterns& noise_lm,
                          double tolerance = 0.002);

}  // namespace luxel
