#include "baker/light/patch_irradiance.h"

#include <algorithm>

#include "baker/formfactors/block_apply.h"

namespace luxel {

std::vector<Rgb> patch_irradiance(BlockSource& source, std::span<const std::array<double, 3>> radiosity,
                                  std::span<const Rgb> lamp_irradiance) {
    const ChunkLayout& layout = source.layout();
    std::vector<Lanes> from(radiosity.size()), arrived(radiosity.size());
    for (std::size_t p = 0; p < radiosity.size(); ++p)
        for (std::size_t c = 0; c < 3; ++c) {
            from[p].v[c] = radiosity[p][c];
            arrived[p].v[c] = source.diagonal_m2()[p] * radiosity[p][c];
        }
    const auto part = [&](std::vector<Lanes>& all, ChunkNumber chunk) {
        return std::span<Lanes>(all).subspan(layout.first_patch[chunk], layout.size(chunk));
    };
    Block block;
    for (std::size_t k = 0; k < source.blocks().size(); ++k) {
        source.load(k, block);
        if (block.a == block.b)
            apply_diagonal(block, 0, layout.size(block.a), part(from, block.a), part(arrived, block.a));
        else
            apply_both(block, part(from, block.a), part(from, block.b), part(arrived, block.a), part(arrived, block.b));
    }
    std::vector<Rgb> irradiance(radiosity.size());
    for (std::size_t p = 0; p < irradiance.size(); ++p)
        for (int c = 0; c < 3; ++c)
            // A diagonal is slightly negative where closure took something back: light is not.
            irradiance[p][c] =
                static_cast<float>(std::max(arrived[p].v[c], 0.0) / source.area_m2()[p]) + lamp_irradiance[p][c];
    return irradiance;
}

}  // namespace luxel
