/// The standard error of every patch's light: what the choice of rays, and nothing else, may have changed.
///
/// Each exchange area carries an independent error of variance G_ij (mu_i g_i + mu_j h_ji) / (mu_i + mu_j)^2 as patch i feels it
/// (g_i: the replicate gain of its own rays, h_ji: that of the count of j's rays on it), weighted by B_j - K_i
/// (row_mean.h); what leaves into the open is a partner with B = 0. The sum over a row is the local variance, known
/// without chance. To follow it through further bounces the errors of all pairs get random signs, keyed by the stable ids of
/// both patches, in 8 patterns which are solved like light (error_propagation.h); what the bounces add to the variance
/// is the mean over the patterns of the square with bounces less the square without.
/// A patch that has missed a bright partner by chance has also missed its variance: each gets its share of what the patches of its neighbourhood
/// have together.
/// Not in it: the finite size of patches, the lamps' direct light, the tolerance of the solve.
#pragma once
#include <vector>

#include "baker/accuracy/replicate_gain.h"

namespace luxel {

struct StandardError {
    std::vector<Channels> radiosity;   ///< sigma of B, lm/m2, per patch
    std::vector<Channels> irradiance;  ///< sigma of H, lm/m2, per patch
    /// sqrt(sum A sigma^2 / sum A) / mean H for the luminance of H: the project's one definition of relative error.
    double relative = 0;
};

/// `gains`: replicate_gain.h, per patch. `mean_irradiance`: of the whole scene, area-weighted, luminance, lamps included.
/// Reads the matrix some 10 times per channel that is lit; equal channels are done once.
StandardError standard_error(BlockSource& source, const LightState& light, const ReplicateGains& gains,
                             double mean_irradiance);

}  // namespace luxel
