/// Directions in bins of equal solid angle: what a patch remembers of where it sees the open sky.
///
/// 32 bands of equal height in y (+1 down to -1), each cut into 32 equal parts of longitude: 4 pi / 1024 sr each, 6 degrees. Bands near
/// the horizon are 4 degrees high, parts 11 wide. Threads: pure functions.
#pragma once
#include <array>
#include <cstdint>

#include "baker/core/vec.h"
#include "formats/bake/sky_view_file.h"

namespace luxel {

constexpr std::uint32_t sky_bands = 32, sky_parts = 32, sky_bin_count = sky_bands * sky_parts;

/// Of a unit direction; below sky_bin_count. Sign tests and products only, so that machines agree but for rounding.
SkyBin sky_bin(const Vec3f& direction);

/// Four directions of a bin, each the middle of a quarter of it.
std::array<Vec3f, 4> directions_in_sky_bin(SkyBin bin);

}  // namespace luxel
