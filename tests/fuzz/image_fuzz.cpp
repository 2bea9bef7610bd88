/// Any bytes as a picture: refused as bad input, or pixels of the size that it says, within the limits. What only the module reads is not
/// tried: the module is taken for missing.
#include <cstddef>
#include <cstdlib>

#include "formats/image/image_file.h"

namespace {

constexpr luxel::ImageLimits limits{.max_side = 256, .max_pixels = 1 << 14};

void require(bool holds) {
    if (!holds) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int*, char***) { return ::setenv("LUXEL_PLUGIN_DIR", "/nowhere", 1); }

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace luxel;
    try {
        const ImagePixels image = decode_image({data, size}, "picture", limits);
        require(image.width > 0 && image.width <= limits.max_side && image.height > 0 && image.height <= limits.max_side);
        require(image.pixels.size() == std::size_t{image.width} * image.height && image.pixels.size() <= limits.max_pixels);
        if (!image.is_float)
            for (const auto& pixel : image.pixels)
                for (const float value : pixel) require(value >= 0 && value <= 1);
    } catch (const Error& error) {
        require(error.code == ErrorCode::bad_input || error.code == ErrorCode::not_in_build);
    }
    return 0;
}
