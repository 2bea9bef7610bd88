/// The light inside one chunk, found in memory up to a rest that the error bound hardly notices.
#pragma once
#include <cstddef>
#include <span>
#include <vector>

#include "baker/solver/adjoint.h"
#include "baker/solver/chunk_system.h"

namespace luxel {

/// How much of A w |residual|, lm in the solver's scale, an inner solve may leave, per channel: the larger of the two.
struct InnerRest {
    Channels allowed{0, 0, 0};
    double share_of_first = 0;  ///< of what the first guess leaves
};

/// An inner solve leaves this share of the light that it is about...
constexpr double inner_share = 1e-3;
/// ...or, where that is more, so little that all chunks together leave a tenth of the tolerance. `power`: sum A B of
/// all patches.
Channels unnoticed_rest(double tolerance, const Channels& power, std::size_t chunk_count);

/// X = arriving + K_aa X for the patches of the chunk, starting from `first_guess`. Whatever X is, callers account for
/// it exactly. One entry per patch, spare lanes 0. Threads: uses them; the result does not depend on their number.
std::vector<Lanes> solve_inside(const Transport& transport, const Adjoint& adjoint, const ChunkSystem& system,
                                std::span<const Lanes> arriving, std::span<const Lanes> first_guess,
                                const InnerRest& rest);

}  // namespace luxel
