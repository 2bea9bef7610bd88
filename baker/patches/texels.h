/// Texels that cover surface, page by page. A texel is a square of the page cut by the triangles of one chart; each
/// triangle's part is a Fragment, from which exact area, positions and normals follow (texel_surface.h).
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "baker/core/vec.h"

namespace luxel {

/// The part of one triangle inside one texel. Stored per texel, sorted by triangle.
struct Fragment {
    std::uint32_t triangle = 0;
    std::uint16_t x = 0, y = 0;  ///< texel on the page of the triangle's chart
    float area_m2 = 0;           ///< > 0, exact area of the clipped polygon in the world
};

struct Texel {
    std::uint16_t x = 0, y = 0;
    std::uint32_t chart = 0;
    std::uint32_t first_fragment = 0, fragment_count = 0;  ///< run in PageTexels::fragments
    float area_m2 = 0;                                     ///< sum over its fragments
    Rgb reflectance;                                       ///< area-weighted mean, 0..1
    Rgb emission;                                          ///< area-weighted mean exitance M, lm/m2
};

/// One page: texels in raster order (y, then x), fragments in texel order.
struct PageTexels {
    std::vector<Texel> texels;
    std::vector<Fragment> fragments;
};

struct TexelSet {
    std::uint32_t page_size = 0;
    std::vector<PageTexels> pages;
    [[nodiscard]] std::uint64_t texel_count() const;
    [[nodiscard]] std::uint64_t resident_bytes() const;
};

}  // namespace luxel
