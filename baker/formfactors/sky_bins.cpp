#include "baker/formfactors/sky_bins.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "baker/core/units.h"

namespace luxel {

SkyBin sky_bin(const Vec3f& direction) {
    const float down = 0.5f * (1 - direction.y) * static_cast<float>(sky_bands);
    const auto band = std::min(static_cast<std::uint32_t>(std::max(down, 0.0f)), sky_bands - 1);
    const float x = std::fabs(direction.x), z = std::fabs(direction.z);
    // From the nearer axis on, an octant has four parts: tan(11.25), tan(22.5) and tan(33.75 degrees).
    const auto parts_from = [](float along, float aside) {
        return std::uint32_t{aside >= 0.19891237f * along} + std::uint32_t{aside >= 0.41421356f * along} + std::uint32_t{aside >= 0.66817864f * along};
    };
    std::uint32_t part = z <= x ? parts_from(x, z) : 7 - parts_from(z, x);  // of the quarter
    if (direction.x < 0) part = 15 - part;
    if (direction.z < 0) part = 31 - part;
    return static_cast<SkyBin>(band * sky_parts + part);
}

std::array<Vec3f, 4> directions_in_sky_bin(SkyBin bin) {
    std::array<Vec3f, 4> directions;
    for (std::size_t k = 0; k < 4; ++k) {
        const double band = bin / sky_parts + (k / 2 == 0 ? 0.25 : 0.75), part = bin % sky_parts + (k % 2 == 0 ? 0.25 : 0.75);
        const double height = 1 - 2 * band / sky_bands, ring = std::sqrt(1 - height * height), along = 2 * pi * part / sky_parts;
        directions[k] = to_float(Vec3d(ring * std::cos(along), height, ring * std::sin(along)));
    }
    return directions;
}

}  // namespace luxel
