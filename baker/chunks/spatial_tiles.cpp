#include "baker/chunks/spatial_tiles.h"

#include <algorithm>
#include <numeric>

#include "baker/chunks/space_halving.h"

namespace luxel {

Tiling number_chunks(std::span<const std::vector<PatchNumber>> chunks, std::size_t patch_count) {
    Tiling tiling;
    tiling.new_number.resize(patch_count);
    PatchNumber next = 0;
    for (const auto& chunk : chunks) {
        for (const PatchNumber old : chunk) tiling.new_number[old] = next++;
        tiling.layout.first_patch.push_back(next);
    }
    return tiling;
}

Tiling tile_patches(const PatchSet& patches, const TileOptions& options) {
    std::vector<Vec3d> places;
    for (const Patch& patch : patches.patches) places.push_back(to_double(patch.center));
    const std::vector<std::uint32_t> sizes(patches.count(), 1);
    std::vector<PatchNumber> all(patches.count());
    std::iota(all.begin(), all.end(), 0u);
    const std::uint32_t limit = std::clamp(options.chunk_patches, 1u, ChunkLayout::max_chunk_patches);
    return number_chunks(halve_space(places, sizes, std::move(all), limit), patches.count());
}

}  // namespace luxel
