/// Places chart rectangles on pages. The only file that names stb_rect_pack.
/// Source: Jylanki, A Thousand Ways to Pack the Bin (2010): skyline bottom-left.
#pragma once
#include <cstdint>
#include <vector>

#include "baker/unwrap/atlas.h"

namespace luxel {

/// Sets page, x, y of every chart; returns the number of pages (0 without charts). Charts are at least `padding` texels
/// apart and that far from the border. They keep their order roughly: charts of one object share pages. Never turns
/// them. Deterministic. Requires width and height <= page_size - 2 * padding; throws Error{internal} otherwise.
std::uint32_t pack_charts(std::vector<Chart>& charts, std::uint32_t page_size, std::uint32_t padding);

}  // namespace luxel
