/// Which patches see the open: a thin round of rays.
#pragma once
#include <cstdint>
#include <vector>

#include "baker/bake/geometry_stages.h"

namespace luxel {

constexpr std::uint32_t open_rays_of_patch = 16;

/// Per patch: how many of its rays, evenly over its surface and cosine-weighted, leave the scene. A pure function of geometry and stable
/// ids. Threads: uses them all.
std::vector<std::uint32_t> count_open_rays(const BakedGeometry& geometry);

}  // namespace luxel
