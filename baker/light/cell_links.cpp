#include "baker/light/cell_links.h"

#include "baker/core/parallel.h"

namespace luxel {
namespace {

/// Is texel (x, y) before `texel` in raster order?
bool is_before(const Texel& texel, std::uint32_t x, std::uint32_t y) {
    return texel.y < y || (texel.y == y && texel.x < x);
}

class Linker {
  public:
    Linker(const Atlas& atlas, const PageTexels& content, const PatchSet& patches, std::uint32_t page,
           std::uint32_t patch_texels)
        : atlas_(atlas),
          texels_(content.texels),
          patches_(patches),
          side_(patch_texels),
          sender_(texels_.size(), no_patch) {
        const std::vector<PatchNumber>& image = patches.page_patch[page];
        parallel_for(texels_.size(), 4096, [&](std::size_t k) {
            const Texel& texel = texels_[k];
            if (content.can_send(texel)) sender_[k] = image[std::size_t{texel.y} * patches.page_size + texel.x];
        });
    }

    std::vector<CellLinks> run() {
        links_.resize(patches_.count());
        std::size_t below = 0;
        for (std::size_t k = 0; k < texels_.size(); ++k) {
            const Texel& texel = texels_[k];
            while (below < texels_.size() && is_before(texels_[below], texel.x, texel.y + 1u)) ++below;
            if (sender_[k] == no_patch) continue;
            const Chart& chart = atlas_.charts[texel.chart];
            if (texel.joined_right && (texel.x - chart.x + 1) % side_ == 0 &&
                is_at(k + 1, texel.x + 1u, texel.y, texel.chart))
                link(k, k + 1, &CellLinks::right, &CellLinks::left);
            if (texel.joined_down && (texel.y - chart.y + 1) % side_ == 0 &&
                is_at(below, texel.x, texel.y + 1u, texel.chart))
                link(k, below, &CellLinks::down, &CellLinks::up);
        }
        return std::move(links_);
    }

  private:
    [[nodiscard]] bool is_at(std::size_t k, std::uint32_t x, std::uint32_t y, std::uint32_t chart) const {
        return k < texels_.size() && texels_[k].x == x && texels_[k].y == y && texels_[k].chart == chart;
    }

    void link(std::size_t a, std::size_t b, PatchNumber CellLinks::*forth, PatchNumber CellLinks::*back) {
        if (sender_[b] == no_patch) return;
        keep_larger(links_[sender_[a]].*forth, sender_[b]);
        keep_larger(links_[sender_[b]].*back, sender_[a]);
    }

    /// Of patches of the same size the first in raster order.
    void keep_larger(PatchNumber& kept, PatchNumber other) const {
        if (kept == no_patch || patches_.patches[other].area_m2 > patches_.patches[kept].area_m2) kept = other;
    }

    const Atlas& atlas_;
    const std::vector<Texel>& texels_;
    const PatchSet& patches_;
    const std::uint32_t side_;
    std::vector<PatchNumber> sender_;  ///< per texel: its patch; no_patch where no ray can start
    std::vector<CellLinks> links_;
};

}  // namespace

std::vector<CellLinks> link_cells(const Atlas& atlas, const PageTexels& content, const PatchSet& patches,
                                  std::uint32_t page, std::uint32_t patch_texels) {
    return Linker(atlas, content, patches, page, patch_texels).run();
}

CellWindow::CellWindow(const std::vector<CellLinks>& links, PatchNumber own, int reach) {
    patch_[index(0)][index(0)] = own;
    const auto step = [&](PatchNumber from, PatchNumber CellLinks::*way) {
        return from == no_patch ? no_patch : links[from].*way;
    };
    // From the middle outwards, so that the cells on the way are known.
    for (int ring_y = 0; ring_y <= reach; ++ring_y)
        for (const int dy : {ring_y, -ring_y})
            for (int ring_x = ring_y == 0 ? 1 : 0; ring_x <= reach; ++ring_x)
                for (const int dx : {ring_x, -ring_x}) {
                    PatchNumber& patch = patch_[index(dy)][index(dx)];
                    if (dy != 0)
                        patch = step(at(dx, dy > 0 ? dy - 1 : dy + 1), dy > 0 ? &CellLinks::down : &CellLinks::up);
                    if (dx != 0 && patch == no_patch)
                        patch = step(at(dx > 0 ? dx - 1 : dx + 1, dy), dx > 0 ? &CellLinks::right : &CellLinks::left);
                }
}

}  // namespace luxel
