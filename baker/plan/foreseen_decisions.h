/// What a bake will leave out once its rays have told that the scene does not need it, as far as a few rays tell before.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "baker/bake/decisions.h"
#include "baker/plan/findings.h"

namespace luxel {

/// Completes what decide() said: a sky that nothing sees, surfaces that no light reaches (one of the `findings`), a matrix of `pairs` that
/// fits into the `cache_bytes` of the solve. Threads: uses them all.
void foresee_decisions(const BakeOptions& options, const BakedGeometry& geometry, std::span<const SceneFinding> findings, std::uint64_t pairs,
                       std::uint64_t cache_bytes, std::vector<Decision>& decisions);

}  // namespace luxel
