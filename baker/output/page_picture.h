/// A page's picture as it goes into the model: encoded in one of the formats, and compared with the float page beside it.
///
/// irradiance = decode(sample) * intensity, in lux per linear Rec.709 channel:
///   png8   lightmap_encode.h, dithered or not
///   png16  decode = sample / 65535; errs by at most intensity / 131070
///   rgbm   decode = rgb / 255 * m / 255 * range, linear, range 8 (texel_codes.h)
///   rgbm-mx  decode = rgb / 255 * (m / 255)^2.2 * range, range 34.49 (texel_codes.h)
///   rgbe   decode = mantissa * 2^(exponent - 136); errs by at most 1/256 of a texel's largest channel
///   exr    half floats; errs by at most 2^-11 of each channel, or intensity * 2^-25 where that is more
///   ktx2   the same halves
/// For the first four the largest channel of the page is the largest code; for the others `intensity` is a power of two, 1 where
/// halves hold every value as it is. Texels without value are black.
///
/// Errors   as encode_lightmap; Error{cannot_write} where a library cannot encode.
/// Threads  uses them all; the bytes do not depend on them.
/// Memory   per texel at most 40 bytes beside what it is given, and the file.
#pragma once
#include <cstdint>
#include <span>
#include <string>

#include "baker/core/vec.h"
#include "baker/output/lightmap_format.h"
#include "baker/output/picture_error.h"
#include "formats/base/bytes.h"

namespace luxel {

struct PagePictureOptions {
    LightmapFormat format = LightmapFormat::png8;
    LightmapEncoding encoding = LightmapEncoding::srgb8;  ///< of png8
    bool dither = true;                                   ///< of png8
    std::string software;                                 ///< name and version of the writer
};

struct PagePicture {
    Bytes file;
    double intensity = 1;
    double range = 0;  ///< of rgbm and rgbm-mx, else 0
    PictureError error;  ///< against the float page as its file holds it (lightmap_exr)
};

/// mask: 0 where a texel has no value (dilate.h). Row 0 is the top.
PagePicture page_picture(std::span<const Rgb> irradiance, std::span<const std::uint8_t> mask, std::uint32_t width, std::uint32_t height,
                         const PagePictureOptions& options);

}  // namespace luxel
