/// What an error of an exchange area is exchanged for.
///
/// Closure keeps the sum of a row: where G_ij comes out too large, mu_i makes up for it in the whole row. As G_ij =
/// c_ij / (mu_i + mu_j), a change of mu_i moves each G_ij by G_ij / (mu_i + mu_j) of it: pairs whose partner has sent
/// many rays hardly give way. So an error dG_ij brings the wrong light dG_ij (B_j - K_i) with the mean
///     K_i = sum_j w_ij B_j / sum_j w_ij,    w_ij = G_ij / (mu_i + mu_j),
/// in which the row's own part has w_ii = G_ii / mu_i and the open share w_i0 = open_i / mu_i and B_0 = 0. With equal
/// densities of rays K_i is what the patch gathers, H_i; where lamps send most of the rays it is far below. To first
/// order, and without what the partners' mu do in turn. Derived here.
#pragma once
#include <span>
#include <vector>

#include "baker/formfactors/block_source.h"
#include "baker/solver/solver.h"

namespace luxel {

/// K per patch, lm/m2; 0 for a row without pairs. `mu`, rays/m2, > 0, and `open_m2` as in LightState. One pass over the
/// matrix; memory 32 bytes per patch. Threads: uses them all; the result does not depend on their number. Throws what
/// source.load() throws.
std::vector<Channels> row_means(BlockSource& source, std::span<const Channels> radiosity, std::span<const double> mu,
                                std::span<const double> open_m2);

}  // namespace luxel
