/// Several right-hand sides of the symmetric form of the radiosity equation, solved side by side in one channel.
#pragma once
#include <array>
#include <cstddef>
#include <vector>

#include "baker/accuracy/light_state.h"
#include "baker/accuracy/pair_pass.h"

namespace luxel {

/// Patterns carried together, one per vector lane.
constexpr std::size_t pattern_count = 8;
/// Single precision: an estimate of an error has no use for more, and there are eight of them.
using Pattern = std::array<float, pattern_count>;
using Patterns = std::vector<Pattern>;

/// sum_j G_ij x_j with the diagonal, per patch. One pass over the matrix.
PatchSums<pattern_count> exchange(BlockSource& source, const Patterns& x);

/// x with (A / rho - G) x = rhs: by how much radiosity changes for light `rhs` (lm) that arrives in addition. The matrix is
/// symmetric, so the same x says by how much sum_i rhs_i B_i changes for a lm more at each patch. Patches that reflect
/// nothing in the channel stay 0.
///
/// Conjugate gradients preconditioned by the diagonal; stops when all residuals are below `tolerance` of the first, or after
/// 60 passes, each of which reads the matrix once. Memory: 200 bytes per patch. Deterministic for any number of threads.
Patterns solve_patterns(BlockSource& source, const LightState& light, std::size_t channel, const Patterns& rhs, double tolerance);

}  // namespace luxel
