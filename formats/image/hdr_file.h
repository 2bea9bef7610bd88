/// Writes Radiance HDR (.hdr). Private to this folder. Reading is a matter of the module.
///
/// Layout   "#?RADIANCE", a comment for each text, "FORMAT=32-bit_rle_rgbe", an empty line, "-Y height +X width", then the rows
///          from the top: each channel of a row in runs, where the width allows that (8 to 32767 pixels), else plain pixels.
/// Threads  pure.
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "formats/base/bytes.h"

namespace luxel {

/// encode_hdr() of image_file.h; line breaks in `texts` become spaces.
Bytes write_hdr(std::uint32_t width, std::uint32_t height, std::span<const std::uint8_t> rgbe,
                const std::vector<std::pair<std::string, std::string>>& texts);

}  // namespace luxel
