#include "baker/accuracy/dark_patches.h"

#include <algorithm>

#include "baker/core/disjoint_sets.h"

namespace luxel {

std::vector<std::uint8_t> find_dark_patches(BlockSource& source, const std::vector<bool>& may_be_lit) {
    const ChunkLayout& layout = source.layout();
    const auto is_all_lit = [&](ChunkNumber chunk) {
        return std::all_of(may_be_lit.begin() + layout.first_patch[chunk], may_be_lit.begin() + layout.first_patch[chunk + 1], [](bool lit) { return lit; });
    };
    std::vector<bool> all_lit(layout.chunk_count());
    for (ChunkNumber chunk = 0; chunk < layout.chunk_count(); ++chunk) all_lit[chunk] = is_all_lit(chunk);
    if (std::ranges::all_of(all_lit, [](bool lit) { return lit; })) return {};

    DisjointSets joined(layout.patch_count());
    Block block;
    for (std::size_t index = 0; index < source.blocks().size(); ++index) {
        const BlockInfo& info = source.blocks()[index];
        if (all_lit[info.a] && all_lit[info.b]) continue;
        source.load(index, block);
        for (std::uint32_t row = 0; row + 1 < block.row_begin.size(); ++row)
            for (std::uint32_t k = block.row_begin[row]; k < block.row_begin[row + 1]; ++k)
                joined.unite(layout.first_patch[info.a] + row, layout.first_patch[info.b] + block.columns[k]);
    }
    std::vector<bool> has_light(layout.patch_count());
    for (PatchNumber p = 0; p < layout.patch_count(); ++p)
        if (may_be_lit[p]) has_light[joined.find(p)] = true;
    std::vector<std::uint8_t> dark(layout.patch_count());
    for (PatchNumber p = 0; p < layout.patch_count(); ++p) dark[p] = !has_light[joined.find(p)];
    if (std::ranges::none_of(dark, [](std::uint8_t is_dark) { return is_dark != 0; })) dark.clear();
    return dark;
}

}  // namespace luxel
