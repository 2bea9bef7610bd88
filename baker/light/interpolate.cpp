#include "baker/light/interpolate.h"

#include <algorithm>
#include <cmath>

#include "baker/core/parallel.h"

namespace luxel {
namespace {

/// The patch of chart `chart` in cell (cx, cy) of its grid that is nearest to texel (x, y), or no_patch. A cell may hold
/// several connected sets; the one that reaches closest is the one that continues the surface.
PatchNumber patch_in_cell(const Chart& chart, const PatchSet& patches, std::uint32_t page, std::int64_t cell_x,
                          std::int64_t cell_y, std::uint32_t cell_texels, const Texel& texel) {
    if (cell_x < 0 || cell_y < 0) return no_patch;
    const std::uint32_t x0 = static_cast<std::uint32_t>(cell_x) * cell_texels;
    const std::uint32_t y0 = static_cast<std::uint32_t>(cell_y) * cell_texels;
    PatchNumber nearest = no_patch;
    std::int64_t nearest_distance = 0;
    for (std::uint32_t y = y0; y < std::min(y0 + cell_texels, chart.height); ++y)
        for (std::uint32_t x = x0; x < std::min(x0 + cell_texels, chart.width); ++x) {
            const std::uint32_t px = chart.x + x, py = chart.y + y;
            if (px >= patches.page_size || py >= patches.page_size) continue;
            const PatchNumber patch = patches.page_patch[page][std::size_t{py} * patches.page_size + px];
            if (patch == no_patch) continue;
            const std::int64_t dx = std::int64_t{px} - texel.x, dy = std::int64_t{py} - texel.y;
            const std::int64_t distance = dx * dx + dy * dy;
            if (nearest == no_patch || distance < nearest_distance) nearest = patch, nearest_distance = distance;
        }
    return nearest;
}

Rgb linear(const Chart& chart, const PatchSet& patches, std::span<const Rgb> irradiance, std::uint32_t page,
           std::uint32_t cell_texels, const Texel& texel) {
    const float side = static_cast<float>(cell_texels);
    const float x = (static_cast<float>(texel.x - chart.x) + 0.5f) / side - 0.5f;
    const float y = (static_cast<float>(texel.y - chart.y) + 0.5f) / side - 0.5f;
    const float floor_x = std::floor(x), floor_y = std::floor(y);
    Rgb sum(0, 0, 0);
    float weights = 0;
    for (int dy = 0; dy < 2; ++dy)
        for (int dx = 0; dx < 2; ++dx) {
            const float wx = dx ? x - floor_x : 1 - (x - floor_x), wy = dy ? y - floor_y : 1 - (y - floor_y);
            const PatchNumber patch = patch_in_cell(chart, patches, page, static_cast<std::int64_t>(floor_x) + dx,
                                                    static_cast<std::int64_t>(floor_y) + dy, cell_texels, texel);
            if (patch == no_patch || wx * wy <= 0) continue;
            sum += irradiance[patch] * (wx * wy);
            weights += wx * wy;
        }
    return sum / weights;
}

}  // namespace

std::vector<Rgb> interpolate_page(const Atlas& atlas, const TexelSet& texels, const PatchSet& patches,
                                  std::span<const Rgb> patch_irradiance, std::uint32_t page, std::uint32_t patch_texels,
                                  Interpolation interpolation) {
    const PageTexels& content = texels.pages[page];
    std::vector<Rgb> result(content.texels.size(), Rgb(0, 0, 0));
    parallel_for(result.size(), 1024, [&](std::size_t k) {
        const Texel& texel = content.texels[k];
        if (!content.can_send(texel)) return;
        const PatchNumber own = patches.page_patch[page][std::size_t{texel.y} * patches.page_size + texel.x];
        result[k] = interpolation == Interpolation::constant
                        ? patch_irradiance[own]
                        : linear(atlas.charts[texel.chart], patches, patch_irradiance, page, patch_texels, texel);
    });
    return result;
}

}  // namespace luxel
