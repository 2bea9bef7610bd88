/// How errors of the light gathered by each patch spread through further bounces, for several error patterns at once.
#pragma once
#include "baker/accuracy/light_state.h"
#include "baker/accuracy/pair_pass.h"

namespace luxel {

/// Patterns carried together, one per vector lane.
constexpr std::size_t pattern_count = 8;
/// Single precision: an estimate of an error has no use for more, and there are eight of them.
using Patterns = std::vector<std::array<float, pattern_count>>;

/// `noise_lm`: wrong light arriving at each patch, A_i dH_i, lm, per pattern. Returns the irradiance error dH of each patch
/// with all bounces, lm/m2, in one channel: dH_i = (noise_i + sum_j G_ij rho_j dH_j) / A_i.
///
/// By conjugate gradients on the symmetric form (A / rho - G) dB = noise, preconditioned by its diagonal, the patterns side
/// by side; stops when all residuals are below `tolerance` of the first, or after 60 passes: an estimate of an error need not
/// be exact. Each pass reads the matrix once. Memory: 200 bytes per patch. Deterministic for any number of threads.
Patterns propagate_errors(BlockSource& source, const LightState& light, std::size_t channel, const Patterns& noise_lm,
                          double tolerance = 0.002);

}  // namespace luxel
