/// Rounds of evidence until there is enough of it: trace, pool, close, solve, ask who needs more rays, trace again.
///
/// Without a wanted error the rounds grow fourfold from 64 rays per patch to `rays`; with one they go on until the standard
/// error is below it. The plan of each round is kept in the bake folder under a name that knows nothing of light, so a
/// bake under other light uses the rays that are there. A matrix which only served to choose rays is removed again.
#pragma once
#include "baker/accuracy/standard_error.h"
#include "baker/bake/solve_stage.h"

namespace luxel {

struct SolvedScene {
    BakedSources sources;
    BakedMatrix matrix;
    BakedSolution solution;
    StandardError error;
};

SolvedScene solve_in_rounds(const BakeOptions& options, const BakedGeometry& geometry, const BakeFolder& folder,
                            const MemoryPlan& plan, StageClock& clock, BakeReport& report);

}  // namespace luxel
