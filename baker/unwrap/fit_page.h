/// From chart shapes in metres to charts in texels that fit a page.
/// Pure and deterministic.
#pragma once
#include <vector>

#include "baker/unwrap/chart_shape.h"

namespace luxel {

/// A chart on its own texel grid. Coordinates in texels, inside [0, width] x [0, height].
struct TexelChart {
    std::vector<std::uint32_t> triangles;         ///< of the ObjectMesh, ascending
    std::vector<std::array<Vec2f, 3>> corner_uv;  ///< corners of the ObjectMesh's triangles
    std::uint32_t width = 1, height = 1;
};

/// Appends the oriented chart at `texels_per_metre`, cut between its triangles where it is hollow and large (its
/// rectangle would waste most of its texels) or wider or higher than `limit` texels. If a single triangle is too large
/// for a page, everything is made smaller first.
/// Returns true if it was made smaller: fewer texels per metre than asked for.
bool fit_chart(const ObjectMesh& mesh, FlatChart chart, double texels_per_metre, std::uint32_t limit,
               std::vector<TexelChart>& out);

/// The same, but keeps the chart in one piece.
bool fit_chart_whole(FlatChart chart, double texels_per_metre, std::uint32_t limit, std::vector<TexelChart>& out);

}  // namespace luxel
