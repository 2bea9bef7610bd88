/// Charts that always work, for triangles that xatlas cannot unwrap: connected triangles of nearly one plane projected
/// onto it; where that overlaps, one chart per triangle. Pure and deterministic.
#pragma once
#include <vector>

#include "baker/unwrap/chart_shape.h"

namespace luxel {

/// Every triangle of `triangles` (ascending) ends up in exactly one chart; all charts are valid (is_valid) and
/// oriented.
std::vector<FlatChart> planar_charts(const ObjectMesh& mesh, const std::vector<std::uint32_t>& triangles,
                                     double samples_per_metre);

}  // namespace luxel
