/// Cuts the patches into chunks: tiles of a fixed grid of halvings of space (space_halving.h). Local and deterministic:
/// a moved chair changes the tiles it left and entered, and no others. It needs no rays, and knows nothing of walls:
/// room_chunks.h does.
#pragma once
#include <span>
#include <vector>

#include "baker/formfactors/block_source.h"
#include "baker/patches/patch.h"

namespace luxel {

struct TileOptions {
    std::uint32_t chunk_patches = 2048;  ///< a tile with more is halved; 1 to 65536. Independent of the memory budget.
};

struct Tiling {
    ChunkLayout layout;
    std::vector<PatchNumber> new_number;  ///< per old number: consecutive per chunk; inside a chunk the old order
};

/// Old order is by surface, then raster; it is kept inside chunks, because neighbours see the same things and bits of
/// the index then come in runs. Patches at one point that cannot be told apart are cut by their order.
Tiling tile_patches(const PatchSet& patches, const TileOptions& options);

/// Numbers patches chunk by chunk in the orders given; every patch below `patch_count` is in exactly one chunk.
Tiling number_chunks(std::span<const std::vector<PatchNumber>> chunks, std::size_t patch_count);

}  // namespace luxel
