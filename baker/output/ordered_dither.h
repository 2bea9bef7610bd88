/// Thresholds for rounding that is right in the mean: a value between two codes takes the upper one where its share of the way from
/// the lower one is above the threshold of its place.
///
/// The thresholds of any neighbourhood are spread evenly over 0..1, so that the mean over n texels of one value is off by little more
/// than a step / n, where independent noise would be off by a step / sqrt(n). All channels of a texel share one: grey stays grey.
///
/// Threads  pure; whole numbers only, so the same on every machine.
/// Source   M. Roberts, The Unreasonable Effectiveness of Quasirandom Sequences (2018): the R2 lattice; 2^32 times its two steps.
#pragma once
#include <cstdint>

namespace luxel {

/// Above 0 and below 1.
inline double dither_threshold(std::uint32_t x, std::uint32_t y) {
    constexpr std::uint32_t step_x = 3242174889u, step_y = 2447445414u;
    const std::uint32_t at = x * step_x + y * step_y;
    return (static_cast<double>(at) + 0.5) * 0x1p-32;
}

}  // namespace luxel
