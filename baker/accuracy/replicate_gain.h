/// How much better the low-discrepancy points of a patch are than independent ones, measured from its replicates.
///
/// The rays of a patch come in R independently scrambled sequences. What a ray of i onto j does to the light that i gathers, once
/// pooled and closed, is v_ij = (B_j - K_i) mu_i / (mu_i + mu_j) per ray of N (row_mean.h; into the open and onto backs -K_i, onto
/// itself B_i - K_i). Each replicate gives e_r = sum_j n_ij^r v_ij / N^r, whose mean e is near 0; their spread says the variance of the
/// mean, s^2 = sum (e_r - e)^2 / (R (R - 1)). Independent rays would have p^2 = sum_j n_ij (v_ij - e)^2 / N^2. One patch has too few
/// replicates for a ratio of its own, so the gain is taken per kind: sum s^2 / h^2 over sum p^2 / h^2, h = sum_j n_ij B_j / N, over the
/// patches with as many rays whose single rays scatter as much (N p^2 / h^2, by powers of four): even light is sampled far
/// more evenly than a doorway. Kinds with few patches take the gain of all with as many rays.
///
/// What others gather from the patch depends on single counts: n_ij has the variance R / (R - 1) sum (n_ij^r - n_ij / R)^2 where
/// independent rays would have n_ij. That gain is taken per power of two of n_ij: a lamp's thousand rays onto one patch of the
/// floor come much more evenly than its three rays onto a far one.
#pragma once
#include <array>
#include <span>
#include <vector>

#include "baker/accuracy/light_state.h"
#include "baker/formfactors/evidence_source.h"

namespace luxel {

struct ReplicateGains {
    std::vector<double> rows;       ///< per patch: ratio of variances of what it gathers by its own rays, 0.02 .. 2
    std::array<double, 33> counts;  ///< entry k: the same of a single count of 2^k .. 2^(k + 1) - 1 rays

    /// Gain of a count of which `rays` are expected; 1 below two.
    [[nodiscard]] double of_count(double rays) const;
};

/// All gains are 1 where they cannot be known (one replicate, no light). Visits the evidence once; memory
/// 8 * (2 R + 3) bytes per patch. `replicates`: R. Throws Error{damaged_store}.
ReplicateGains replicate_gains(const EvidenceSource& evidence, const LightState& light, std::uint32_t replicates);

}  // namespace luxel
