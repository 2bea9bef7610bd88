/// Places rectangles on pages, or tightly beside each other. The only file that names stb_rect_pack.
/// Both functions are deterministic and never turn a rectangle. Texels.
/// Source: Jylanki, A Thousand Ways to Pack the Bin (2010): skyline bottom-left.
#pragma once
#include <cstdint>
#include <vector>

namespace luxel {

struct PackedRectangle {
    std::uint32_t width = 0, height = 0;          ///< given
    std::uint32_t page = 0, x = 0, y = 0;         ///< found: page and corner
};

/// Sets page, x, y of every rectangle; returns the number of pages (0 without rectangles). They are at least `padding` texels
/// apart and that far from the border. They keep their order roughly: those of one object share pages.
/// Requires width and height <= page_size - 2 * padding; throws Error{internal} otherwise.
std::uint32_t pack_pages(std::vector<PackedRectangle>& rectangles, std::uint32_t page_size, std::uint32_t padding);

/// Sets x and y of every rectangle so that their common one, with its corner at (0, 0), is small and not long. Page 0. They are at
/// least `padding` texels apart. Returns that common one; width 0 where no side of at most `limit` was enough.
PackedRectangle pack_tightly(std::vector<PackedRectangle>& rectangles, std::uint32_t limit, std::uint32_t padding);

}  // namespace luxel
