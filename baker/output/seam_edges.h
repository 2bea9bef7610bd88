/// Where lightmaps are cut although the surface goes on: stretches along which two borders of charts meet in space.
/// Geometry only; what is done about them is in seam_samples.h and seam_join.h.
///
/// Two borders meet where edges of two triangles run along the same line in opposite directions (so that each surface
/// begins where the other ends), as far as they overlap: edges with the same two end points, an edge beside parts of a
/// longer one (T-junctions), tiles that are set off against each other. The charts may be one chart (a tube cut open),
/// two of an object, or of different objects and pages. Distances up to a 2^20th of the largest coordinate, some
/// roundings of a float, are none; edges below eight times that are points. What ends 1/64 texel from where it goes on
/// in the same chart is no seam.
///
/// Only smooth surface has seams: at both ends of the stretch the shading normals agree within 8 degrees, and the faces
/// themselves within 60, so that the rim of a thin sheet, rounded by its normals, stays a rim. At a hard crease the
/// light itself jumps, and stays.
///
/// Time and memory are linear in the edges: borders lie in a hash grid with a level for each power of two of their
/// lengths, so that an edge is compared only with longer ones near it, with `most_candidates` of each level at most,
/// and has `most_partners` at most (a million copies in one place stay cheap). Peak: about 150 bytes per edge on a
/// border. Threads: uses them all; the result depends on nothing else. Errors: none.
#pragma once
#include <cstdint>
#include <vector>

#include "baker/scene/scene.h"
#include "baker/unwrap/atlas.h"

namespace luxel {

/// One side of a stretch: the edge from corner `edge` of the triangle to the next corner, or a part of it.
struct SeamSide {
    std::uint32_t triangle = 0;
    std::uint32_t edge = 0;  ///< 0..2
    Vec2f from, to;          ///< texels of the chart's page
};

/// `from` of both sides is one point in space, and so is `to`.
struct Seam {
    SeamSide a, b;
};

namespace seam_limits {
constexpr std::size_t most_partners = 8, most_candidates = 256;
}

/// All of them, in order of the shorter edge (triangle, then corner).
std::vector<Seam> find_seams(const Scene& scene, const Atlas& atlas);

}  // namespace luxel
