/// Texels that cover surface, page by page. A texel is a square of the page cut by the triangles of one chart; each
/// triangle's part is a Fragment, from which exact area, positions and normals follow (texel_surface.h).
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "baker/core/vec.h"
#include "baker/patches/visible_cells.h"

namespace luxel {

/// The part of one triangle inside one texel. Stored per texel, sorted by triangle.
struct Fragment {
    std::uint32_t triangle = 0;
    std::uint16_t x = 0, y = 0;  ///< texel on the page of the triangle's chart
    float area_m2 = 0;           ///< > 0, exact area of the clipped polygon in the world, visible or not
    /// The raster leaves all; trace/visible_area.h takes away what is inside solids.
    VisibleCells visible = all_visible;            ///< cells in the open altogether: where rays may start
    std::uint16_t visible_parts = fragment_parts;  ///< of the area, cut cells included: 0..fragment_parts

    [[nodiscard]] float visible_m2() const { return area_m2 * (static_cast<float>(visible_parts) / fragment_parts); }
};

struct Texel {
    std::uint16_t x = 0, y = 0;
    std::uint32_t chart = 0;
    std::uint32_t first_fragment = 0, fragment_count = 0;  ///< run in PageTexels::fragments
    float area_m2 = 0;                                     ///< sum over its fragments
    float visible_m2 = 0;  ///< sum over them; 0: inside a solid
    Rgb reflectance;       ///< mean over the visible area (the whole where none is), 0..1
    Rgb emission;          ///< the same of the exitance M, lm/m2
    /// Nothing parts it from the next texel of its chart along x, along y: set by trace/texel_joints.h. True where there is none.
    bool joined_right = true, joined_down = true;
    /// Cells of its square (bit 4 * row + column) on its own side of a wall without thickness that parts it from the texel beyond; all
    /// where there is none. Set with the joints.
    VisibleCells own_side = all_visible;
};

/// One page: texels in raster order (y, then x), fragments in texel order.
struct PageTexels {
    std::vector<Texel> texels;
    std::vector<Fragment> fragments;

    /// Number of the texel at (x, y) if it is of `chart`, else `none`.
    [[nodiscard]] std::uint32_t find(std::uint32_t x, std::uint32_t y, std::uint32_t chart) const {
        const std::uint32_t number = find(x, y);
        return number != none && texels[number].chart == chart ? number : none;
    }
    /// The same of any chart.
    [[nodiscard]] std::uint32_t find(std::uint32_t x, std::uint32_t y) const {
        const auto at = std::lower_bound(texels.begin(), texels.end(), std::pair(y, x), [](const Texel& texel, const auto& place) {
            return std::pair<std::uint32_t, std::uint32_t>(texel.y, texel.x) < place;
        });
        if (at == texels.end() || at->x != x || at->y != y) return none;
        return static_cast<std::uint32_t>(at - texels.begin());
    }
    /// Can rays start on the texel? If not, it holds no light of its own and is filled from its neighbours.
    [[nodiscard]] bool can_send(const Texel& texel) const {
        const auto first = fragments.begin() + texel.first_fragment;
        return std::any_of(first, first + texel.fragment_count, [](const Fragment& f) { return f.visible != none_visible; });
    }
};

struct TexelSet {
    std::uint32_t page_size = 0;
    std::vector<PageTexels> pages;
    [[nodiscard]] std::uint64_t texel_count() const;
    [[nodiscard]] std::uint64_t resident_bytes() const;
};

}  // namespace luxel
