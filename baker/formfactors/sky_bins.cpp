#include "baker/formfactors/sky_bins.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace luxel {

std::uint8_t sky_bin(const Vec3f& direction) {
    const float down = 0.5f * (1 - direction.y) * static_cast<float>(sky_bands);
    const auto band = std::min(static_cast<std::uint32_t>(std::max(down, 0.0f)), sky_bands - 1);
    // The octant of longitude, then which half of it: tan(22.5 degrees) = sqrt(2) - 1.
    constexpr float half_octant = 0.41421356f;
    const float x = std::fabs(direction.x), z = std::fabs(direction.z);
    std::uint32_t part = z <= x ? (z < half_octant * x ? 0 : 1) : (x > half_octant * z ? 2 : 3);  // of the quarter
    if (direction.x < 0) part = 7 - part;
    if (direction.z < 0) part = 15 - part;
    return static_cast<std::uint8_t>(band * sky_parts + part);
}

}  // namespace luxel
