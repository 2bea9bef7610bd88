/// What the two fuzz targets of pictures share: any bytes are refused as bad input, or are pixels of the size that they
/// say, within small limits. A broken promise aborts.
#pragma once
#include <cstdlib>

#include "formats/image/image_file.h"

namespace luxel::fuzz {

inline void check_picture(ByteView bytes, bool has_module) {
    constexpr ImageLimits limits{.max_side = 256, .max_pixels = 1 << 14};
    const auto require = [](bool holds) {
        if (!holds) std::abort();
    };
    try {
        const ImagePixels image = decode_image(bytes, "picture", limits);
        require(image.width > 0 && image.width <= limits.max_side && image.height > 0 && image.height <= limits.max_side);
        require(image.pixels.size() == std::size_t{image.width} * image.height && image.pixels.size() <= limits.max_pixels);
        if (!image.is_float)
            for (const auto& pixel : image.pixels)
                for (const float value : pixel) require(value >= 0 && value <= 1);
    } catch (const Error& error) {
        require(error.code == ErrorCode::bad_input || (error.code == ErrorCode::not_in_build && !has_module));
    }
}

}  // namespace luxel::fuzz
