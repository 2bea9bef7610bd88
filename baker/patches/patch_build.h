/// Texels -> patches: cells of k x k texels of each chart's own grid, split into sets that hang together (texels.h: joined).
///
/// Only what is visible of a texel counts; a set that lies inside solids altogether is no patch, and one of which nothing but
/// slivers is seen, so that no ray can start there, joins the nearest patch of its chart. Power is exact: for every patch the sum over its texels of visible area times emission is area_m2 times emission (double
/// sums, rounded once). Numbers run in chart order, then raster order of cells, then of sets in a cell. Threads:
/// parallel inside; the result does not depend on it.
#pragma once
#include <span>
#include <vector>

#include "baker/patches/patch.h"
#include "baker/scene/scene.h"
#include "baker/unwrap/atlas.h"

namespace luxel {

struct PatchOptions {
    std::uint32_t patch_texels = 4;  ///< side of a cell in texels, 1 .. 256
};

/// The stable name (see patch.h). `cell_x`, `cell_y` on the chart's grid of cells; `set` counts the connected sets of
/// the cell in raster order of their first texels.
PatchId patch_id(const Object& object, const Chart& chart, float texels_per_metre, std::uint32_t patch_texels,
                 std::uint32_t cell_x, std::uint32_t cell_y, std::uint32_t set, bool is_back, std::uint32_t level);

/// Throws Error{usage} for options out of range, Error{internal} naming both objects if two patches get the same id.
PatchSet build_patches(const Scene& scene, const Atlas& atlas, const TexelSet& texels, const PatchOptions& options);

}  // namespace luxel
