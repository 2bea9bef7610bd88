/// Cuts the patches into chunks: tiles of a fixed grid of halvings of space. Local and deterministic: the lines are
/// multiples of powers of two in metres around the scene's origin, so a moved chair changes the tiles it left and
/// entered, and no others.
#pragma once
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

/// Old order is by surface, then raster; it is kept inside chunks, because neighbours see the same things and bits of the
/// index then come in runs. Patches at one point that cannot be told apart are cut by their order.
Tiling tile_patches(const PatchSet& patches, const TileOptions& options);

}  // namespace luxel
