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

/// encode_png() of image_file.h; `texts` become text chunks, in this order.
std::string write_png(std::uint32_t width, std::uint32_t height, std::span<const std::uint8_t> rgb,
                      const std::vector<std::pair<std::string, std::string>>& texts, Bytes& out);

}  // namespace luxel
