/// How much surface is there where it lets light through: a texel of a fence is mostly holes, one of a pane mostly clear.
///
/// The area of a see-through surface is its area times its mean opacity (scene/see_through.h): so much of what comes by meets it,
/// and so much of it reflects and emits. Reflectance and emission are those of what is met, so power is exact, a ray that meets the
/// surface by the chance of its opacity finds all of it, and exchange areas are symmetric: each side counts by opacity once.
/// Cells without any cover (the holes of a mask) are no surface: no ray starts there, and texels all of holes hold no light of
/// their own. Where opacity varies inside a texel, rays start evenly on what of its cells is covered: positions may be wrong by
/// less than a texel, areas are not.
/// Threads: uses them all. Errors: none.
#pragma once
#include "baker/patches/texels.h"
#include "baker/scene/see_through.h"
#include "baker/unwrap/atlas.h"

namespace luxel {

/// Of the visible cells of a fragment whose material can be seen through (of all cells where none is): means over a grid of points, as
/// fine as its textures are, up to 4 x 4 in a cell. `covered`: cells in which any point has cover.
struct FragmentPassage {
    SeeThroughMean mean;
    VisibleCells covered = none_visible;
};
FragmentPassage fragment_passage(const Scene& scene, const Atlas& atlas, const Fragment& fragment);

/// Takes holes from Fragment::visible, multiplies visible_parts by the mean opacity (at least one part where a cell is left, so that a
/// clear pane has light of its own), and sets the sums of texels that change. After trace/visible_area.h. Call once.
void thin_see_through(const Scene& scene, const Atlas& atlas, TexelSet& texels);

}  // namespace luxel
