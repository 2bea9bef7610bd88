/// The up to eight neighbours of a texel of a page.
#pragma once
#include <algorithm>
#include <cstdint>

namespace luxel {

/// Calls visit(index) for each, in raster order. `texel` < width * height.
template <class Visit>
void for_neighbours(std::uint64_t texel, std::uint32_t width, std::uint32_t height, const Visit& visit) {
    const auto x = static_cast<std::int64_t>(texel % width), y = static_cast<std::int64_t>(texel / width);
    for (std::int64_t ny = std::max<std::int64_t>(y - 1, 0); ny <= std::min<std::int64_t>(y + 1, height - 1); ++ny)
        for (std::int64_t nx = std::max<std::int64_t>(x - 1, 0); nx <= std::min<std::int64_t>(x + 1, width - 1); ++nx)
            if (nx != x || ny != y) visit(static_cast<std::uint64_t>(ny) * width + static_cast<std::uint64_t>(nx));
}

}  // namespace luxel
