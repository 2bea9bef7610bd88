/// Directions in bins of equal solid angle: what a patch remembers of where it sees the open sky.
///
/// 16 bands of equal height in y (+1 down to -1), each cut into 16 equal parts of longitude: 4 pi / 256 sr each. Bands near
/// the horizon are 7 degrees high. Threads: pure functions.
#pragma once
#include <cstdint>

#include "baker/core/vec.h"

namespace luxel {

constexpr std::uint32_t sky_bands = 16, sky_parts = 16, sky_bin_count = sky_bands * sky_parts;

/// Of a unit direction; below sky_bin_count. Sign tests and products only, so that machines agree but for rounding.
std::uint8_t sky_bin(const Vec3f& direction);

}  // namespace luxel
