/// False colours of relative errors, and the small picture of a bake's error maps.
///
/// The scale is logarithmic from 0.1 % (dark blue) to 100 % (bright yellow), with a brightness that only rises, so that it can be read without
/// telling hues apart. Threads: pure.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <string>

#include "baker/sweep/error_meter.h"
#include "formats/base/bytes.h"

namespace luxel {

constexpr double least_shown_error = 1e-3, most_shown_error = 1;

/// sRGB, 8 bits.
using Colour8 = std::array<std::uint8_t, 3>;
Colour8 error_colour(double relative_error);

/// "#rrggbb"
std::string colour_text(const Colour8& colour);

/// A PNG: the maps side by side, at most four of them, those with the largest errors; without surface is transparent.
Bytes error_map_png(std::span<const ErrorMap> maps);

}  // namespace luxel
