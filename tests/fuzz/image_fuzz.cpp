/// Any bytes as a picture that the program reads without the module of OpenImageIO: PNG, JPEG, OpenEXR. The module is taken
/// for missing; image_module_fuzz has it.
#include <cstddef>

#include "tests/fuzz/picture_promises.h"

extern "C" int LLVMFuzzerInitialize(int*, char***) { return ::setenv("LUXEL_PLUGIN_DIR", "/nowhere", 1); }

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    luxel::fuzz::check_picture({data, size}, false);
    return 0;
}
