/// Texels that a wall without thickness runs through. To patches such a texel belongs on one side, and what lies on the other side of the
/// wall to the texel there: rays of its patch start on its own side only, and what meets it on the other belongs to the patch there. So no
/// light passes the wall. What the lightmap shows in the texel is the mean over both sides, as everywhere.
///
/// Stored   one bit per texel of every page, if there are any at all, and 8 bytes for each.
/// Threads  const and reentrant once made. Errors: none.
#pragma once
#include <cstdint>
#include <vector>

#include "baker/patches/texels.h"
#include "baker/scene/scene.h"
#include "baker/unwrap/atlas.h"

namespace luxel {

class PartedTexels {
  public:
    PartedTexels() = default;
    /// Of texels whose joints and sides are known (trace/texel_joints.h).
    explicit PartedTexels(const TexelSet& texels);

    /// `place`: y * page size + x.
    [[nodiscard]] bool holds(std::uint32_t page, std::size_t place) const {
        return !pages_.empty() && (pages_[page].bits[place / 64] >> (place % 64) & 1) != 0;
    }
    /// Place of the texel to which the point (u, v), 0..1, of a held texel belongs: its own, or one beside it.
    [[nodiscard]] std::size_t owner(std::uint32_t page, std::size_t place, float u, float v) const;
    [[nodiscard]] bool empty() const { return pages_.empty(); }
    [[nodiscard]] std::uint64_t resident_bytes() const;

  private:
    struct Parted {
        std::uint32_t place;
        VisibleCells own_side;  ///< Texel::own_side
        std::uint8_t step;      ///< number of the step to the texel on the other side
    };
    struct Page {
        std::vector<std::uint64_t> bits;
        std::vector<Parted> texels;  ///< by place
    };
    std::vector<Page> pages_;
    std::uint32_t page_size_ = 0;
};

/// Of the visible cells of a texel's fragment those on the texel's own side, by their middles.
VisibleCells cells_on_own_side(const Scene& scene, const Atlas& atlas, const Texel& texel, const Fragment& fragment);

}  // namespace luxel
