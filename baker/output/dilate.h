/// Fills the padding around charts, so that a viewer's bilinear filter and mipmaps never mix in texels without surface.
///
/// values   one per texel of a page, row 0 at the top; changed only where `mask` is empty.
/// mask     per texel: 0 empty, anything else holds a value. Filled texels become texel_filled.
/// steps    how many texels to grow, 8-connected; usually the atlas padding.
/// Result   each step gives every empty texel with neighbours the mean of those that held a value before the step, summed
///          in raster order, so the result depends on nothing else. Growing a covered page is free: the work is
///          proportional to the texels that are filled.
/// Threads  pure; one page per call.
#pragma once
#include <cstdint>
#include <span>

#include "baker/core/vec.h"

namespace luxel {

constexpr std::uint8_t texel_empty = 0, texel_covered = 1, texel_filled = 2;
/// Covered by surface inside a solid: no light of its own. Only fill_hidden() takes it.
constexpr std::uint8_t texel_hidden = 3;

void dilate(std::span<Rgb> values, std::span<std::uint8_t> mask, std::uint32_t width, std::uint32_t height,
            std::uint32_t steps);

}  // namespace luxel
