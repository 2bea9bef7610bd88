/// Patches that lie together on one surface: what is estimated for each alone is steadier for all of them.
/// Threads: none. Errors: none. A pure function of geometry and emission.
#pragma once
#include <cstdint>
#include <vector>

#include "baker/patches/patch.h"
#include "baker/unwrap/atlas.h"

namespace luxel {

/// Per patch the number of its neighbourhood, 0, 1, ... without gaps: patches of the same side of one chart whose first
/// texels lie in the same square of `texels` x `texels` texels, lamps apart from what does not shine.
std::vector<std::uint32_t> neighbourhoods(const Atlas& atlas, const PatchSet& patches, std::uint32_t texels);

}  // namespace luxel
