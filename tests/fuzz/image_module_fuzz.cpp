/// Any bytes as a picture that the module of OpenImageIO reads: WebP, Radiance HDR, JPEG in CMYK, OpenEXR in luminance and
/// chroma. Others are left to image_fuzz where their first bytes say so.
#include <cstddef>

#include "tests/fuzz/picture_promises.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size > 0 && data[0] == 0x89) return 0;  // PNG
    luxel::fuzz::check_picture({data, size}, true);
    return 0;
}
