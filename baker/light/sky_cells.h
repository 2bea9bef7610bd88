/// Walks a sky in small cells: for quadrature.
#pragma once
#include <algorithm>
#include <cmath>
#include <vector>

#include "baker/core/units.h"
#include "baker/scene/scene.h"

namespace luxel {

/// Calls visit(direction, solid_angle_sr, pixel) for cells that cut the picture's pixels until they are at most
/// 2 pi / `columns` wide and as high. Solid angles add up to 4 pi.
template <class Visit>
void for_each_sky_cell(const SkyMap& map, std::uint32_t columns, const Visit& visit) {
    const std::uint32_t across = (columns + map.width - 1) / map.width, down = (columns / 2 + map.height - 1) / map.height;
    const std::uint32_t wide = map.width * across, high = map.height * down;
    std::vector<double> cosine(wide), sine(wide);
    for (std::uint32_t x = 0; x < wide; ++x) {
        const double along = 2 * pi * ((x + 0.5) / wide - 0.5) - map.turn;
        cosine[x] = std::cos(along), sine[x] = std::sin(along);
    }
    for (std::uint32_t y = 0; y < high; ++y) {
        const double top = std::cos(pi * y / high), low = std::cos(pi * (y + 1) / high);
        // The middle by area.
        const double height = 0.5 * (top + low), ring = std::sqrt(std::max(0.0, 1 - height * height));
        const double solid_angle = (top - low) * 2 * pi / wide;
        for (std::uint32_t x = 0; x < wide; ++x)
            visit(Vec3d(ring * cosine[x], height, ring * sine[x]), solid_angle,
                  std::size_t{y / down} * map.width + x / across);
    }
}

}  // namespace luxel
