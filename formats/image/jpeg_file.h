/// JPEG, with TurboJPEG. Private to this folder.
#pragma once
#include <optional>
#include <string>

#include "formats/image/image_file.h"

namespace luxel {

/// Grey and colour, also progressive; smoothly upsampled colour, the exact transform. Nothing: CMYK or YCCK, a matter for the module.
/// Whatever the library is in doubt about, damage or an early end, is refused.
std::optional<std::string> decode_jpeg(ByteView bytes, const ImageLimits& limits, ImagePixels& out);

}  // namespace luxel
