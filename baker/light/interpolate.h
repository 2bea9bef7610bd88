/// Draft light: irradiance of the patches spread over their texels, without gathering.
#pragma once
#include <span>
#include <vector>

#include "baker/patches/patch.h"
#include "baker/unwrap/atlas.h"

namespace luxel {

enum class Interpolation {
    constant,  ///< the texel's own patch
    linear     ///< bilinear between the centres of the four nearest cells of the same chart; absent ones are left out
};

/// Irradiance (lux) of each texel of page `page` in texel order, from the irradiance per patch number. Never reads across
/// a chart border. 0 where nothing of a texel is visible. `patch_texels`: side of a cell, as in PatchOptions.
std::vector<Rgb> interpolate_page(const Atlas& atlas, const TexelSet& texels, const PatchSet& patches,
                                  std::span<const Rgb> patch_irradiance, std::uint32_t page, std::uint32_t patch_texels,
                                  Interpolation interpolation);

}  // namespace luxel
