/// Draft light: irradiance of the patches spread over their texels, without gathering.
///
/// The value of a patch is taken as that of the middle of its cell. Only patches that continue each other's surface
/// take part (cell_links.h): never across a chart border, nor through a wall that stands on the chart. Kernels continue
/// the slope where cells are missing (cell_values.h); means at corners are those of the patches that are there.
#pragma once
#include <array>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "baker/patches/patch.h"
#include "baker/unwrap/atlas.h"

namespace luxel {

enum class Interpolation {
    constant,       ///< the texel's own patch
    linear,         ///< bilinear between the middles of the four nearest cells
    cubic_bspline,  ///< cubic B-spline over 4 x 4 cells: smoothest, never outside the values around, but does not keep
                    ///< them
    catmull_rom,    ///< cubic over 4 x 4 cells, through the values in the middles; may overshoot, but not below 0
    corners         ///< values averaged at the corners that patches share, then bilinear inside each patch
};

constexpr std::array<Interpolation, 5> all_interpolations{Interpolation::constant, Interpolation::linear,
                                                          Interpolation::cubic_bspline, Interpolation::catmull_rom,
                                                          Interpolation::corners};

/// Their names on the command line and in reports: "constant", "linear", "cubic-bspline", "catmull-rom", "corners".
const char* interpolation_name(Interpolation interpolation);
/// None: there is no such name.
std::optional<Interpolation> interpolation_of(std::string_view name);

/// Irradiance (lux, finite) of each texel of page `page` in texel order, from the irradiance per patch number (>= 0). 0
/// where no ray can start from a texel. `patch_texels`: side of a cell, as in PatchOptions. Threads: uses them all.
/// Errors: none. Source: Keys, Cubic Convolution Interpolation for Digital Image Processing, IEEE ASSP 29(6) 1981
/// (Catmull-Rom is its a = -1/2); Cohen and Wallace, Radiosity and Realistic Image Synthesis (1993), ch. 9 (corners).
std::vector<Rgb> interpolate_page(const Atlas& atlas, const TexelSet& texels, const PatchSet& patches,
                                  std::span<const Rgb> patch_irradiance, std::uint32_t page, std::uint32_t patch_texels,
                                  Interpolation interpolation);

}  // namespace luxel
