/// Looks for what will cost light, time or beauty, before any form factor is computed: docs/plan.md says what each code means.
/// Threads: use them all. Errors: none. All are pure functions of their arguments.
#pragma once
#include "baker/bake/geometry_stages.h"
#include "baker/plan/findings.h"

namespace luxel {

/// What geometry and materials tell: uv1-unfit, density, bright-surfaces, dark-lamps, far-from-origin, coincident-faces.
std::vector<SceneFinding> lint_scene(const BakedGeometry& geometry);

/// What a thin round of rays tells: open-room, unlit-surfaces, dark-fronts.
std::vector<SceneFinding> lint_light(const BakedGeometry& geometry);

}  // namespace luxel
