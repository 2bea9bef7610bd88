#include "baker/patches/patch_lookup.h"

namespace luxel {

PatchNumber front_patch_near(const Chart& chart, const PatchSet& patches, std::uint32_t x, std::uint32_t y, float u,
                             float v) {
    const auto& image = patches.page_patch[chart.page];
    PatchNumber best = no_patch;
    float best_distance = 0;
    for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
            const std::int64_t nx = std::int64_t{x} + dx, ny = std::int64_t{y} + dy;
            // The chart's rectangle holds texels of this chart only.
            if (nx < 0 || ny < 0 || nx >= chart.width || ny >= chart.height) continue;
            const PatchNumber patch = image[static_cast<std::size_t>(chart.y + ny) * patches.page_size +
                                            static_cast<std::size_t>(chart.x + nx)];
            if (patch == no_patch) continue;
            const float left = static_cast<float>(nx), top = static_cast<float>(ny);
            const float du = u < left ? left - u : u > left + 1 ? u - left - 1 : 0;
            const float dv = v < top ? top - v : v > top + 1 ? v - top - 1 : 0;
            const float distance = du * du + dv * dv;
            if (best == no_patch || distance < best_distance) best = patch, best_distance = distance;
        }
    return best;
}

PatchNumber front_patch_of_parted(const PatchSet& patches, const SurfaceTexel& at) {
    const std::vector<PatchNumber>& image = patches.page_patch[at.chart->page];
    const PatchNumber owner = image[patches.parted.owner(at.chart->page, place_on_page(patches, at), at.u - static_cast<float>(at.x), at.v - static_cast<float>(at.y))];
    if (owner != no_patch) return owner;
    return *at.patch != no_patch ? *at.patch : front_patch_near(*at.chart, patches, at.x, at.y, at.u, at.v);
}

}  // namespace luxel
