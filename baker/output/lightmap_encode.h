/// Irradiance of one page <-> 8 bits per channel and a factor.
///
/// irradiance = decode(byte) * intensity, in lux per linear Rec.709 channel. `intensity` is the page's largest channel
/// value, so nothing is clipped; 1 for a page without light. A byte is the one whose decoded value is nearest (the
/// smaller one on a tie), so the error of a texel is at most half a step: intensity / 510 for linear8, and for srgb8 at
/// most intensity * 0.0046 at the bright end, and below intensity * 0.00016 at the dark end.
/// Dithered, a value between two bytes becomes one or the other by its place in the page (ordered_dither.h), so that the mean of the
/// decoded values over an even surface is the value; the error of a texel is then below a whole step. What a byte stands for
/// exactly, such as 0 and the largest value, stays.
/// The tables are computed with + - * / only, so the bytes do not depend on a machine's mathematical library.
///
/// Errors   Error{internal} on values that are not finite, or on sizes that do not fit. Negative values become 0.
/// Threads  pure.
/// Source   IEC 61966-2-1 (sRGB); glTF's reader: three.js with SRGBColorSpace.
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "baker/core/vec.h"
#include "formats/base/bytes.h"
#include "formats/image/image_file.h"

namespace luxel {

enum class LightmapEncoding {
    srgb8,   ///< byte is sRGB encoded, as colour textures of glTF are
    linear8  ///< byte is proportional to irradiance
};

/// "srgb8", "linear8".
const char* encoding_name(LightmapEncoding encoding);
/// Throws Error{usage} listing the names.
LightmapEncoding parse_encoding(const std::string& name);

struct EncodedPage {
    std::vector<std::uint8_t> rgb;  ///< 3 per texel, black where the mask is empty
    double intensity = 1;           ///< > 0, exactly a float
};

/// mask: 0 where a texel has no value (dilate.h). dither_width: 0 takes the nearest byte; else dithered, rows of that many texels.
EncodedPage encode_lightmap(std::span<const Rgb> irradiance, std::span<const std::uint8_t> mask,
                            LightmapEncoding encoding, std::uint32_t dither_width = 0);

/// The same of values that are shares already, 0..1: intensity 1.
EncodedPage encode_shares(std::span<const Rgb> shares, std::span<const std::uint8_t> mask, LightmapEncoding encoding,
                          std::uint32_t dither_width = 0);

/// The largest channel of all texels with a value; 1 for a page without light. Throws as said above.
double largest_light(std::span<const Rgb> irradiance, std::span<const std::uint8_t> mask);

/// Share of the intensity that a byte stands for, 0..1.
double decode_lightmap_byte(std::uint8_t byte, LightmapEncoding encoding);

/// The PNG of an encoded page with its meaning as metadata. `software`: name and version of the writer.
Bytes lightmap_png(const EncodedPage& page, LightmapEncoding encoding, std::uint32_t width, std::uint32_t height,
                   const std::string& software);

/// The page as OpenEXR, RGB, half where that keeps every value (exr_sample_for), intensity 1. Empty texels are 0.
Bytes lightmap_exr(std::span<const Rgb> irradiance, std::span<const std::uint8_t> mask, std::uint32_t width,
                   std::uint32_t height, const std::string& software);

}  // namespace luxel
