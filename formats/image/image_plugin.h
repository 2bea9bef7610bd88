/// The contract between image_file.cpp and the module that holds the image library. Private to this folder.
/// Exceptions never cross it: a call returns an empty text, or why it failed.
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "formats/image/image_file.h"

namespace luxel {

/// Raised whenever anything below changes.
constexpr std::uint32_t image_plugin_version = 2;

/// Text attributes first to last, then numbers.
struct PluginAttributes {
    std::vector<std::pair<std::string, std::string>> texts;
    std::vector<std::pair<std::string, float>> numbers;
};

/// ExrPart as the library wants it.
struct PluginPart {
    std::string name;
    std::vector<std::string> channels;
    ExrSample sample;
    PluginAttributes attributes;
};

struct ImagePlugin {
    std::uint32_t version;
    /// `extension` chooses the reader ("png"). Checks the limits before the pixels are allocated.
    std::string (*decode)(ByteView bytes, const char* extension, const ImageLimits& limits, ImagePixels& out);
    std::string (*encode_exr)(const ImageView& image, ExrSample sample, const PluginAttributes& attributes, Bytes& out);
    /// `values` points to the samples of a part, as float or as std::uint32_t, until its next call; it does not throw, nullptr
    /// gives up.
    std::string (*encode_exr_parts)(std::uint32_t width, std::uint32_t height, std::span<const PluginPart> parts,
                                    const std::function<const void*(std::size_t part)>& values, Bytes& out);
    std::string (*encode_png)(std::uint32_t width, std::uint32_t height, std::span<const std::uint8_t> rgb,
                              const PluginAttributes& attributes, Bytes& out);
};

/// The module's only exported function, by this name.
constexpr const char* image_plugin_entry = "luxel_image_plugin";
using ImagePluginEntry = const ImagePlugin* (*)();

}  // namespace luxel
