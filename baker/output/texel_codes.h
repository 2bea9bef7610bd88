/// One texel <-> the codes of the formats that share something between its channels, or scale a page.
///
/// Threads  pure. Only + - * / and exact powers of two: the same codes on every machine.
/// Source   RGBE: G. Ward, Real Pixels, Graphics Gems II (1991). RGBM: B. Karis, RGBM Color Encoding (2009); its other curve: MX_lightmap (R. Long),
///          with the numbers of Unity's lightmaps in linear colour space.
#pragma once
#include <array>
#include <cstdint>
#include <span>

namespace luxel {

using TexelBytes = std::array<std::uint8_t, 4>;
using TexelValues = std::array<double, 3>;

/// Mantissas and exponent: channel = mantissa * 2^(exponent - 136). Of the nearest mantissas, so each channel errs by at most 1/256 of the
/// largest one. Channels >= 0; what is below 2^-136 is 0. The largest channel must be below 2^127.
TexelBytes rgbe_of(const TexelValues& values);
TexelValues rgbe_values(const TexelBytes& bytes);

/// channel = rgb * m / 65025, rgb and m in 0..255, for channels 0..1, linear. m is the smallest that reaches the largest channel, or
/// one up to a sixteenth above it that errs less in the channel where it errs most (the larger of equals). No larger one, although
/// it may err less still: where neighbours differ in m, viewers that interpolate the four numbers get the product wrong by up to
/// (1 + r)^2 / (4 r) - 1 for a ratio r, 0.1 % for a sixteenth. Each channel errs by at most (255 * largest + 1) / 130050. A black texel has m = 255, so that the
/// way from it to a bright neighbour is even.
TexelBytes rgbm_of(const TexelValues& shares);
TexelValues rgbm_shares(const TexelBytes& bytes);

/// What a viewer multiplies decoded RGBM with, beside the intensity: the range that most readers of RGBM lightmaps take.
constexpr double rgbm_range = 8;

/// channel = rgb / 255 * (m / 255)^2.2, for channels 0..1. m is the smallest that reaches the largest channel, or one up to 1/28 above it that errs less: for a
/// ratio r of m between neighbours, interpolating the four numbers gets the product wrong by ((1 + r) / 2)^2.2 (1 + r^-2.2) / 2 - 1, which is 0.1 % there.
/// With s the largest channel each errs by at most (s^(1/2.2) + 1/255)^2.2 / 510. A black texel has m = 0: beside dark texels, whose m is small, any
/// larger one would shine when the four are interpolated.
TexelBytes rgbm_mx_of(const TexelValues& shares);
TexelValues rgbm_mx_shares(const TexelBytes& bytes);

/// The range of readers of MX_lightmap: Unity's is 5^2.2 = 34.493.
constexpr double rgbm_mx_range = 34.49;

/// Factor for formats whose texels are half floats, or become halves in viewers: 1 where halves keep every value (exr_sample_for), else
/// the power of two that brings the largest value into [2^14, 2^15).
double half_intensity(std::span<const float> values);

}  // namespace luxel
