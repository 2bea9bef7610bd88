/// What a bake of this scene will do, and what it will leave out because the scene does not need it.
#pragma once
#include "baker/bake/geometry_stages.h"
#include "baker/plan/findings.h"

namespace luxel {

/// In the order of the bake. The conditions are those of the stages themselves. Threads: a pure function. Errors: none.
std::vector<Decision> decide(const BakeOptions& options, const BakedGeometry& geometry);

}  // namespace luxel
