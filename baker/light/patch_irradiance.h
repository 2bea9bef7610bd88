/// Irradiance per patch from the solution: what drafts interpolate.
#pragma once
#include <span>
#include <vector>

#include "baker/core/vec.h"
#include "baker/formfactors/block_source.h"

namespace luxel {

/// H_i = (sum_j G_ij B_j) / A_i + direct light of lamps, lux. One read of the half matrix; blocks are applied in order, so
/// the sums do not depend on threads.
std::vector<Rgb> patch_irradiance(BlockSource& source, std::span<const std::array<double, 3>> radiosity,
                                  std::span<const Rgb> lamp_irradiance);

}  // namespace luxel
