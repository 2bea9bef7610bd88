/// Values of the cells around a patch, with those that are missing: what a kernel is laid over.
/// Threads: pure. Errors: none.
#pragma once
#include <array>
#include <span>

#include "baker/light/cell_links.h"

namespace luxel {

/// A missing cell continues the slope of the two next to it, inwards along x or y, and the mean of both where both can
/// be continued; but it is not below 0. So a straight slope stays one up to the border of a chart, where reflecting the
/// values, or leaving the cells out, would flatten it: the light of a room changes most along its edges (docs/drafts.md
/// has the figures). A chart one cell wide has no slope: its values are continued as they are.
class CellValues {
  public:
    /// `values` per patch number, >= 0; `reach` as of the window.
    CellValues(const CellWindow& window, std::span<const Rgb> values, int reach);
    CellValues() = default;

    /// Cell (dx, dy), each -reach .. reach.
    [[nodiscard]] const Vec3d& at(int dx, int dy) const { return value_[index(dy)][index(dx)]; }

  private:
    static constexpr std::size_t side = 2 * window_reach + 1;
    static std::size_t index(int d) { return static_cast<std::size_t>(d + window_reach); }

    std::array<std::array<Vec3d, side>, side> value_;
};

}  // namespace luxel
