/// Reads one part of an OpenEXR file by its name: a layer (docs/layers.md). Channels and samples stay as they are, unlike decode_image(),
/// which makes colours of them.
///
/// Errors   Error{bad_input} naming `where`: not OpenEXR, damaged, too large, no such part (the message lists those that are there).
/// Threads  reentrant.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "formats/image/image_file.h"

namespace luxel {

/// Samples interleaved by channels, these in the order of their names, row 0 at the top.
struct DecodedExrPart {
    std::uint32_t width = 0, height = 0;
    std::vector<std::string> channels;
    ExrPartValues values;  ///< whole numbers where all channels are
};

/// `where` names the picture in messages. Limits are checked before anything is allocated.
DecodedExrPart decode_exr_part(ByteView bytes, const std::string& name, const std::string& where, const ImageLimits& limits = {});

}  // namespace luxel
