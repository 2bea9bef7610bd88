/// The contract between image_file.cpp and the module that holds OpenImageIO, for the rarer kinds of pictures. Private to this
/// folder.
/// Exceptions never cross it: a call returns an empty text, or why it failed.
#pragma once
#include <cstdint>
#include <string>

#include "formats/image/image_file.h"

namespace luxel {

/// Raised whenever anything below changes.
constexpr std::uint32_t image_plugin_version = 3;

struct ImagePlugin {
    std::uint32_t version;
    /// `extension` chooses the reader ("png"). Checks the limits before the pixels are allocated.
    std::string (*decode)(ByteView bytes, const char* extension, const ImageLimits& limits, ImagePixels& out);
};

/// The module's only exported function, by this name.
constexpr const char* image_plugin_entry = "luxel_image_plugin";
using ImagePluginEntry = const ImagePlugin* (*)();

}  // namespace luxel
