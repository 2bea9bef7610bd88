/// Where the light went: emitted = absorbed + lost (+ what is still under way), in lm per channel.
///
/// The sums come from different quantities (irradiance as accumulated by the solver, rows of the matrix, emission), so
/// their balance is a test of matrix, reciprocity and solver; at convergence it holds to about the tolerance.
/// Sizes: one entry per patch everywhere. Threads: pure.
#pragma once
#include <span>

#include "baker/solver/solver.h"

namespace luxel {

struct EnergyAudit {
    Channels emitted_lm{0, 0, 0};    ///< sum A M
    Channels absorbed_lm{0, 0, 0};   ///< sum A (1 - rho) H
    Channels lost_lm{0, 0, 0};       ///< sent into the open or onto backs: sum (A_i - row sum i) (B - unshot)
    Channels remaining_lm{0, 0, 0};  ///< sum A unshot: not sent yet
    /// |emitted - absorbed - lost - remaining| / emitted, the worst channel; 0 without light.
    double imbalance = 0;
};

/// `row_open_m2`: A_i minus the row sum of G with its diagonal (Closure::row_open_m2). In a channel in which nothing
/// reflects all light is taken as sent once, since solvers need not send it to know B.
EnergyAudit audit_energy(std::span<const double> area_m2, std::span<const double> row_open_m2, const SolveInput& input,
                         const SolveResult& result);

}  // namespace luxel
