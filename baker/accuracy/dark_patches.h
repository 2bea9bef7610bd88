/// Which patches no light can reach, whatever is reflected how often: those that are joined by no chain of pairs of the matrix to any that
/// may have light. In closed rooms without a lamp nothing need be gathered.
///
/// Each pair stands for a ray that went from one to the other. What shines inside a closed room sends its rays to the room, so it is
/// joined to it; a room that is lit through a gap too narrow for all rays of its patches and of those outside is dark here, and its light is below
/// what these rays can tell. In the open a small lamp far away may be joined to nothing that it lights.
#pragma once
#include <cstdint>
#include <vector>

#include "baker/formfactors/block_source.h"

namespace luxel {

/// Per patch: 1 if dark, else 0; empty if none is. `may_be_lit`: per patch, those that have light of any kind, their own or from others, as
/// far as that is known, and those that see the open: the more there are, the fewer blocks are read. Threads: one. Throws what source.load() throws.
std::vector<std::uint8_t> find_dark_patches(BlockSource& source, const std::vector<bool>& may_be_lit);

}  // namespace luxel
