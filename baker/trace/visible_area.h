/// Which parts of the surface lie inside solids or behind walls, where nobody sees them and no light comes: they must not
/// count as area, else objects that intersect get dark seams.
///
/// Which points are hidden: hidden_point.h.
///
/// Found per fragment. Most take a few rays at one point: short segments just above the surface tell whether anything cuts it; where
/// nothing does, one point stands for all. Of the others the corners of the 4 x 4 cells (patches/visible_cells.h) are
/// examined, and 4 x 4 points of cells with a visible one: they make the area (trapezoidal rule), and a cell is one to
/// start from when all of its points are visible. Fragments below a sixteenth of a texel are one cell of 3 x 3 points. The outermost
/// points lie a 256th of the fragment inside its border; what is narrower than that is not found.
/// Threads: uses them all. A pure function of geometry, of what shines and of where lamps are; errors: none.
#pragma once
#include "baker/patches/texels.h"
#include "baker/trace/tracer.h"
#include "baker/unwrap/atlas.h"

namespace luxel {

struct VisibleAreaTally {
    std::uint64_t hidden_texels = 0;  ///< nothing of them is visible
    std::uint64_t cut_texels = 0;     ///< a part is
    double hidden_m2 = 0;
};

/// Sets Fragment::visible and visible_parts, and the sums and means of texels that it changes. `texels` as the raster made them; `near_m`:
/// how far parts of one patch may reach behind a wall, m, >= 0.
VisibleAreaTally find_visible_area(const Scene& scene, const Atlas& atlas, const Tracer& tracer, float near_m,
                                   TexelSet& texels);

}  // namespace luxel
