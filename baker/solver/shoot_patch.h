/// Progressive refinement as it was first: patch by patch, the one with most unshot power first (Cohen, Chen, Wallace,
/// Greenberg 1988). The baseline that shooting by chunk (shoot.h) is measured against: a shot reads the whole row of
/// the patch's chunk to send the light of one patch.
///
/// Same bound as shoot.h; its weights are never lowered. Memory: 168 bytes per patch with the result. Threads: one.
#pragma once
#include "baker/solver/solver.h"

namespace luxel {

/// No reads at all where there is no light or nothing reflects. Throws what source.load() throws.
SolveResult solve_by_shooting_patches(BlockSource& source, const SolveInput& input, const SolveOptions& options);

}  // namespace luxel
