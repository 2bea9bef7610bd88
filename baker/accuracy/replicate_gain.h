/// How much better the low-discrepancy points of a patch are than independent ones, measured from its replicates.
///
/// The rays of a patch come in R independently scrambled sequences. Each gives an estimate h_r = sum_j n_ij^r B_j / N^r of
/// what the patch gathers; their spread says the variance of the mean, s^2 = sum (h_r - h)^2 / (R (R - 1)). Independent rays
/// would have p^2 = sum_j n_ij (B_j - h)^2 / N^2 (rays into the open or onto backs bring 0). One patch has too few
/// replicates for a ratio of its own, so the gain is taken per level: sum s^2 / h^2 over sum p^2 / h^2 over the patches
/// with that many rays.
#pragma once
#include <span>
#include <vector>

#include "baker/accuracy/light_state.h"
#include "formats/bake/evidence_file.h"

namespace luxel {

/// Ratio of variances, 0.02 .. 2, per patch: that of the patch's level. 1 where it cannot be known (one replicate, no
/// light). Reads each file once, in order; memory 8 * (2 R + 2) bytes per patch. `replicates`: R.
/// Throws Error{damaged_store}.
std::vector<double> replicate_gains(std::span<const EvidenceFile> files, const LightState& light, std::uint32_t replicates);

}  // namespace luxel
