#include "baker/patches/neighbourhoods.h"

#include <map>
#include <tuple>

namespace luxel {

std::vector<std::uint32_t> neighbourhoods(const Atlas& atlas, const PatchSet& patches, std::uint32_t texels) {
    std::map<std::tuple<std::uint32_t, bool, bool, std::uint32_t, std::uint32_t>, std::uint32_t> numbers;
    std::vector<std::uint32_t> of_patch(patches.count());
    for (PatchNumber p = 0; p < patches.count(); ++p) {
        const Patch& patch = patches.patches[p];
        const Chart& chart = atlas.charts[patch.chart];
        const Fragment& first = patches.fragments_of(p).front();
        const std::tuple key(patch.chart, patch.is_back, patch.emission != Rgb(0, 0, 0), (first.x - chart.x) / texels,
                             (first.y - chart.y) / texels);
        of_patch[p] = numbers.emplace(key, static_cast<std::uint32_t>(numbers.size())).first->second;
    }
    return of_patch;
}

}  // namespace luxel
