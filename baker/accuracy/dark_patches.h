/// Which patches no light can reach, whatever is reflected how often: those that are joined by no chain of pairs of the matrix to any that
/// has light. In closed rooms without a lamp nothing need be gathered.
///
/// Each pair stands for a ray that went from one to the other. A room that is lit through a gap too narrow for all rays of its patches
/// and of those outside is dark here, and its light is below what these rays can tell.
#pragma once
#include <cstdint>
#include <vector>

#include "baker/formfactors/block_source.h"

namespace luxel {

/// Per patch: 1 if dark, else 0; empty if none is. `is_lit`: per patch, those that have light of any kind, their own or from others, as far
/// as that is known: the more are known, the fewer blocks are read. Threads: one. Throws what source.load() throws.
std::vector<std::uint8_t> find_dark_patches(BlockSource& source, const std::vector<bool>& is_lit);

}  // namespace luxel
