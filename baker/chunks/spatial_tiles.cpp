#include "baker/chunks/spatial_tiles.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace luxel {
namespace {

struct Box {
    Vec3d low, high;
};

class Tiler {
  public:
    Tiler(const PatchSet& patches, std::uint32_t limit) : patches_(patches), limit_(limit) {}

    /// `members` in old order. Emits tiles in the order low half before high half.
    void cut(std::vector<PatchNumber> members, const Box& box, int depth) {
        if (members.empty()) return;
        constexpr int max_depth = 96;
        if (members.size() <= limit_ || depth == max_depth) {
            for (std::size_t begin = 0; begin < members.size(); begin += limit_) {
                const auto end = std::min<std::size_t>(members.size(), begin + limit_);
                tiles.emplace_back(members.begin() + static_cast<std::ptrdiff_t>(begin),
                                   members.begin() + static_cast<std::ptrdiff_t>(end));
            }
            return;
        }
        // Longest edge first; ties go to x, then z: floors are wider than they are high.
        const Vec3d size = box.high - box.low;
        const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.z >= size.y ? 2 : 1;
        const double middle = 0.5 * (box.low[axis] + box.high[axis]);
        std::vector<PatchNumber> low, high;
        for (const PatchNumber p : members)
            (static_cast<double>(patches_.patches[p].center[axis]) < middle ? low : high).push_back(p);
        members = {};
        Box half = box;
        half.high[axis] = middle;
        cut(std::move(low), half, depth + 1);
        half = box;
        half.low[axis] = middle;
        cut(std::move(high), half, depth + 1);
    }

    std::vector<std::vector<PatchNumber>> tiles;

  private:
    const PatchSet& patches_;
    std::size_t limit_;
};

}  // namespace

Tiling tile_patches(const PatchSet& patches, const TileOptions& options) {
    double reach = 0;
    for (const Patch& patch : patches.patches)
        for (int k = 0; k < 3; ++k) reach = std::max(reach, std::fabs(static_cast<double>(patch.center[k])));
    // The first box is a power of two, so that its halvings stay where they are when the scene grows a little.
    const double half = std::exp2(std::ceil(std::log2(std::max(reach, 1e-30)) + 1e-9));
    std::vector<PatchNumber> all(patches.count());
    std::iota(all.begin(), all.end(), 0u);
    Tiler tiler(patches, std::clamp(options.chunk_patches, 1u, ChunkLayout::max_chunk_patches));
    tiler.cut(std::move(all), {{-half, -half, -half}, {half, half, half}}, 0);

    Tiling tiling;
    tiling.new_number.resize(patches.count());
    PatchNumber next = 0;
    for (const auto& tile : tiler.tiles) {
        for (const PatchNumber old : tile) tiling.new_number[old] = next++;
        tiling.layout.first_patch.push_back(next);
    }
    return tiling;
}

}  // namespace luxel
