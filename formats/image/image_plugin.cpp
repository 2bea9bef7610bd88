// OpenImageIO's only user; built as a module of its own (see image_file.h).
#include "formats/image/image_plugin.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "formats/image/codec.h"

namespace luxel {
namespace {

namespace io = OIIO;

std::string first_line(std::string text, const char* otherwise) {
    if (const auto end = text.find('\n'); end != std::string::npos) text.resize(end);
    return text.empty() ? otherwise : text;
}

/// Where R, G, B and A are among the channels of a file; alpha -1: none. By name where there are names, else by order.
struct ChannelMap {
    int red = 0, green = 0, blue = 0, alpha = -1;
};

ChannelMap map_channels(const io::ImageSpec& spec) {
    const auto find = [&](const char* name) {
        const auto at = std::find(spec.channelnames.begin(), spec.channelnames.end(), name);
        return at == spec.channelnames.end() ? -1 : static_cast<int>(at - spec.channelnames.begin());
    };
    ChannelMap map;
    if (spec.nchannels >= 3) {
        const int red = find("R"), green = find("G"), blue = find("B");
        const bool named = red >= 0 && green >= 0 && blue >= 0;
        map.red = named ? red : 0;
        map.green = named ? green : 1;
        map.blue = named ? blue : 2;
    }
    map.alpha = find("A");
    return map;
}

/// The WebP reader multiplies alpha in whatever it is told. Undone as far as 8 bits allow; black where alpha is 0.
void divide_by_alpha(std::array<float, 4>& pixel) {
    for (std::size_t c = 0; c < 3; ++c) pixel[c] = pixel[3] > 0 ? std::min(pixel[c] / pixel[3], 1.0f) : 0.0f;
}

std::string decode_body(ByteView bytes, const char* extension, const ImageLimits& limits, ImagePixels& out) {
    io::Filesystem::IOMemReader source(bytes.data(), bytes.size());
    io::ImageSpec wish;
    wish.attribute("oiio:UnassociatedAlpha", 1);  // values as stored: alpha is not multiplied in
    const std::string name = std::string("memory.") + extension;
    const auto input = io::ImageInput::create(extension);
    if (!input) return first_line(io::geterror(), "this kind of picture is not supported");
    io::ImageSpec spec;
    if (!input->set_ioproxy(&source) || !input->open(name, spec, wish))
        return first_line(input->geterror(), "it is damaged");
    if (spec.depth > 1 || spec.nchannels < 1) return "it has no pixels";
    if (std::string why = size_trouble(spec.width, spec.height, limits); !why.empty()) return why;

    const auto width = static_cast<std::size_t>(spec.width), height = static_cast<std::size_t>(spec.height);
    const auto channels = static_cast<std::size_t>(spec.nchannels);
    const ChannelMap map = map_channels(spec);
    const bool alpha_is_multiplied_in = map.alpha >= 0 && std::string_view(extension) == "webp";
    out.width = static_cast<std::uint32_t>(width);
    out.height = static_cast<std::uint32_t>(height);
    out.is_float = spec.format.is_floating_point();
    out.pixels.resize(width * height);
    // A band of rows at a time: the file's own channels are never held for the whole picture beside the result.
    const bool tiled = spec.tile_width > 0;
    const int band_rows = tiled ? spec.tile_height : 64;
    std::vector<float> band(width * static_cast<std::size_t>(band_rows) * channels);
    for (int row = 0; row < spec.height; row += band_rows) {
        const int end = std::min(row + band_rows, spec.height);
        const bool read = tiled ? input->read_tiles(0, 0, spec.x, spec.x + spec.width, spec.y + row, spec.y + end, 0, 1,
                                                    0, spec.nchannels, io::TypeFloat, band.data())
                                : input->read_scanlines(0, 0, spec.y + row, spec.y + end, 0, 0, spec.nchannels,
                                                        io::TypeFloat, band.data());
        if (!read) return first_line(input->geterror(), "it is damaged or cut short");
        for (std::size_t pixel = 0; pixel < width * static_cast<std::size_t>(end - row); ++pixel) {
            const float* from = band.data() + pixel * channels;
            auto& to = out.pixels[static_cast<std::size_t>(row) * width + pixel];
            to = {from[map.red], from[map.green], from[map.blue], map.alpha < 0 ? 1.0f : from[map.alpha]};
            if (alpha_is_multiplied_in) divide_by_alpha(to);
        }
    }
    return {};
}

std::string decode(ByteView bytes, const char* extension, const ImageLimits& limits, ImagePixels& out) {
    return guarded([&] { return decode_body(bytes, extension, limits, out); });
}

}  // namespace
}  // namespace luxel

extern "C" __attribute__((visibility("default"))) const luxel::ImagePlugin* luxel_image_plugin() {
    // Callers parallelise over pictures; threads inside would only compete with them.
    static const bool configured = [] {
        OIIO::attribute("threads", 1);
        OIIO::attribute("exr_threads", -1);
        return true;
    }();
    static const luxel::ImagePlugin plugin{luxel::image_plugin_version, luxel::decode};
    return configured ? &plugin : nullptr;
}
