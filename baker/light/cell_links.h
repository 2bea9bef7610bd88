/// Which patches continue each other's surface on the grid of their chart: known once per page, so that no texel has to
/// search the cells around it.
/// Threads: uses them all. Errors: none. A pure function of texels and patches.
#pragma once
#include <array>
#include <vector>

#include "baker/patches/patch.h"
#include "baker/unwrap/atlas.h"

namespace luxel {

/// The patches in the next cells; no_patch where the surface ends. `up` is towards y = 0.
struct CellLinks {
    PatchNumber left = no_patch, right = no_patch, up = no_patch, down = no_patch;
};

/// Per patch number; without links for patches of other pages, and for backs. Two patches are linked if texels of both,
/// side by side across a line of the grid (cells of `patch_texels` x `patch_texels`), are of one chart, hold light of
/// their own (PageTexels::can_send) and are not parted (Texel::joined_right, joined_down): so no link leads through a
/// wall, nor through the inside of one. A cell that something cuts holds several patches; the largest of those that
/// touch is the one that continues the surface.
std::vector<CellLinks> link_cells(const Atlas& atlas, const PageTexels& content, const PatchSet& patches,
                                  std::uint32_t page, std::uint32_t patch_texels);

/// Cells that are looked at on each side of a patch's own.
constexpr int window_reach = 2;

/// The patches around one patch, as they are seen from it.
class CellWindow {
  public:
    /// `reach`: cells on each side, 0 .. window_reach. A cell is seen if a way of links leads to it that never turns
    /// back; along x first where two ways end in different patches of a cut cell.
    CellWindow(const std::vector<CellLinks>& links, PatchNumber own, int reach);
    CellWindow() = default;

    [[nodiscard]] PatchNumber own() const { return at(0, 0); }
    /// Cell (dx, dy) from its own, each -window_reach .. window_reach; no_patch where none is seen.
    [[nodiscard]] PatchNumber at(int dx, int dy) const { return patch_[index(dy)][index(dx)]; }

  private:
    static constexpr std::size_t side = 2 * window_reach + 1;
    static std::size_t index(int d) { return static_cast<std::size_t>(d + window_reach); }
    static constexpr std::array<PatchNumber, side> empty_row{no_patch, no_patch, no_patch, no_patch, no_patch};

    std::array<std::array<PatchNumber, side>, side> patch_{empty_row, empty_row, empty_row, empty_row, empty_row};
};

}  // namespace luxel
