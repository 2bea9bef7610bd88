/// What of a fragment lies in the open and not inside a solid: how much of its area, and which of its 4 x 4 cells do so
/// altogether (bit 4 * row + column). Rays start on those cells only: on a cell that something cuts they might start inside
/// of it. The cells are those of FragmentPolygon::point(s, t), column of s and row of t, so each has a sixteenth of the
/// fragment's area.
/// Threads: pure functions. Errors: none.
#pragma once
#include <algorithm>
#include <bit>
#include <cstdint>

#include "baker/core/vec.h"

namespace luxel {

using VisibleCells = std::uint16_t;
constexpr std::uint32_t cells_across = 4;
constexpr VisibleCells all_visible = 0xffff, none_visible = 0;

/// Visible area is counted in these parts of the fragment, 36 to a cell (trace/visible_area.h).
constexpr std::uint16_t fragment_parts = 576;

/// Middle of a cell as (s, t).
inline Vec2f cell_middle(std::uint32_t cell) {
    constexpr float side = 1.0f / cells_across;
    return {(static_cast<float>(cell % cells_across) + 0.5f) * side, (static_cast<float>(cell / cells_across) + 0.5f) * side};
}

/// Moves (s, t) in [0, 1) onto the visible cells, so that uniform points are uniform over them; `cells` is not empty.
/// t chooses the row and s the cell in it: strata stay together.
inline Vec2f onto_visible(VisibleCells cells, float s, float t) {
    if (cells == all_visible) return {s, t};
    constexpr float below_one = 0x1.fffffep-1f, side = 1.0f / cells_across;
    float rest = t * static_cast<float>(std::popcount(cells));
    std::uint32_t row = 0, bits = 0;
    float in_row = 0;
    for (std::uint32_t r = 0; r < cells_across; ++r) {
        const std::uint32_t here = (cells >> (cells_across * r)) & 15u;
        if (!here) continue;
        if (bits) rest -= in_row;
        row = r, bits = here, in_row = static_cast<float>(std::popcount(here));
        if (rest < in_row) break;
    }
    const float along = s * in_row;
    std::uint32_t skip = std::min(static_cast<std::uint32_t>(along), static_cast<std::uint32_t>(std::popcount(bits)) - 1);
    const float inside = along - static_cast<float>(skip);
    for (; skip > 0; --skip) bits &= bits - 1;
    const auto column = static_cast<float>(std::countr_zero(bits));
    // Rounding must not reach the next cell.
    const auto in_cell = [](float cell, float place) { return std::min((cell + place) * side, (cell + 1) * side * below_one); };
    return {in_cell(column, inside), in_cell(static_cast<float>(row), std::max(rest / in_row, 0.0f))};
}

}  // namespace luxel
