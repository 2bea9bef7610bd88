/// Where every triangle lies on the lightmap pages. Built by unwrap.h, then const.
#pragma once
#include <cstdint>
#include <vector>

#include "baker/core/vec.h"

namespace luxel {

/// Connected triangles of one object, flattened without overlap. Its own texel grid starts at (0, 0); the packer only
/// adds whole texels (x, y), so what lies in a cell of the grid does not depend on where the chart is packed.
struct Chart {
    std::uint32_t object = 0;
    std::uint32_t ordinal = 0;  ///< number of the chart within its object: part of stable patch ids
    std::uint32_t page = 0;
    std::uint32_t x = 0, y = 0;           ///< texel of the page at the chart's origin
    std::uint32_t width = 0, height = 0;  ///< texels that the chart may cover: corner_uv stays inside [0, width] x [0, height]
    std::uint32_t first = 0, count = 0;   ///< run in Atlas::chart_triangles
};

/// The charts of one instance that keep their places to each other, so that copies of a mesh can share one layout: only where the
/// block lies differs.
struct CopyBlock {
    std::uint32_t first_object = 0, object_count = 0;  ///< all objects of the instance
    std::uint32_t layout = 0;  ///< blocks with the same number have the same charts in the same places, relative to the block
    std::uint32_t page = 0;
    std::uint32_t x = 0, y = 0;           ///< texel of the page at its corner
    std::uint32_t width = 0, height = 0;  ///< texels; its charts lie inside, without padding around them
};

/// Sides that a page may have, in texels.
constexpr std::uint32_t smallest_page = 16, largest_page = 16384;

struct Atlas {
    float texels_per_metre = 0;
    std::uint32_t page_size = 0;  ///< pages are square, in texels
    std::uint32_t page_count = 0;
    std::uint32_t padding = 0;  ///< free texels around each chart at least
    std::vector<Chart> charts;
    std::vector<CopyBlock> copy_blocks;          ///< of instances that share a layout with copies, by object; others have none
    std::vector<std::uint32_t> chart_triangles;  ///< triangles of the scene, grouped by chart, ascending inside a chart
    std::vector<std::uint32_t> triangle_chart;   ///< per triangle of the scene; every triangle has a chart
    std::vector<Vec2f> corner_uv;                ///< 3 per triangle of the scene: chart-local texel coordinates

    /// Coordinates of a corner in texels of its page.
    [[nodiscard]] Vec2f page_uv(std::uint32_t triangle, int corner) const {
        const Chart& chart = charts[triangle_chart[triangle]];
        const Vec2f& local = corner_uv[std::size_t{3} * triangle + static_cast<std::size_t>(corner)];
        return {local.x + static_cast<float>(chart.x), local.y + static_cast<float>(chart.y)};
    }
    [[nodiscard]] std::uint64_t resident_bytes() const;
};

}  // namespace luxel
