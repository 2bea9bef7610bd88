/// Reads a scene as a bake would, up to its patches, and says what will run, how much there is of everything, and what is wrong with it.
#pragma once
#include <optional>

#include "baker/bake/bake.h"
#include "baker/bake/decisions.h"
#include "baker/plan/advice.h"
#include "baker/plan/findings.h"
#include "baker/plan/forecast.h"

namespace luxel {

/// What to foresee. All options lead to the same geometry.
struct PlanWishes {
    std::vector<NamedOptions> presets;
    std::vector<NamedOptions> ladder;  ///< rising in quality and time, to choose from by `seconds`
    double seconds = 0;                ///< 0: no matter
    std::uint64_t disk_bytes = 0;      ///< of form factors; 0: no matter
};

struct PlanReport {
    std::uint64_t triangles = 0, charts = 0, pages = 0, texels = 0, patches = 0, chunks = 0;
    double texels_per_metre = 0;
    std::uint64_t geometry_bytes = 0;  ///< resident, which --memory does not count
    std::uint64_t floor_bytes = 0;     ///< the least --memory that these options work with
    std::vector<StageReport> stages;
    std::vector<Forecast> forecasts;  ///< one per preset that was asked for
    std::optional<Forecast> choice;   ///< the best of the ladder within the wished seconds, or its first
    std::vector<Advice> advice;       ///< where --memory or a wish will not hold
    std::vector<Decision> decisions;
    std::vector<SceneFinding> findings;  ///< of the scene, then of its light
    std::vector<Warning> warnings;  ///< of the reader and the unwrapper, as a bake has them
};

/// `options` are those of the bake; their output is not written, and may be empty. With a bake folder (`options.work`) the atlas is kept
/// there, so that the bake finds it. Throws what reading throws; Error{stopped_early} if `options.stop` was asked before it was
/// complete. Threads: uses options.threads.
PlanReport plan_bake(const BakeOptions& options, const PlanWishes& wishes = {});

}  // namespace luxel
