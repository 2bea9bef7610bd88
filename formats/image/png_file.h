/// PNG, with libpng. Private to this folder.
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "formats/image/image_file.h"

namespace luxel {

/// All kinds of PNG: 1 to 16 bits, grey, colour, palette, interlaced. 16 bits are kept; gAMA, iCCP and the like are not looked at.
/// What is damaged or cut short is refused.
std::string decode_png(ByteView bytes, const ImageLimits& limits, ImagePixels& out);

/// Rows one after the other, top first, without gaps: width * channels * bits / 8 bytes each.
struct PngSamples {
    std::uint32_t width = 0, height = 0;
    int channels = 3;  ///< 3: RGB, 4: RGBA
    int bits = 8;      ///< 8, or 16 in the order of this machine
    const std::uint8_t* first = nullptr;
};

/// The encoders of image_file.h; `texts` become text chunks, in this order.
std::string write_png(const PngSamples& samples, const std::vector<std::pair<std::string, std::string>>& texts, Bytes& out);

}  // namespace luxel
