// The image library's only user; built as a module of its own (see image_file.h).
#include "formats/image/image_plugin.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <exception>
#include <new>
#include <string_view>

namespace luxel {
namespace {

namespace io = OIIO;

/// Runs `body`, and turns whatever it throws into text.
template <class Body>
std::string guarded(const Body& body) {
    try {
        return body();
    } catch (const std::bad_alloc&) {
        return "not enough memory";
    } catch (const std::exception& error) {
        return error.what();
    } catch (...) {
        return "unknown failure of the image library";
    }
}

std::string first_line(std::string text, const char* otherwise) {
    if (const auto end = text.find('\n'); end != std::string::npos) text.resize(end);
    return text.empty() ? otherwise : text;
}

std::string check_size(const io::ImageSpec& spec, const ImageLimits& limits) {
    if (spec.width < 1 || spec.height < 1 || spec.depth > 1 || spec.nchannels < 1) return "it has no pixels";
    const auto width = static_cast<std::uint64_t>(spec.width), height = static_cast<std::uint64_t>(spec.height);
    if (width > limits.max_side || height > limits.max_side || width * height > limits.max_pixels)
        return "expected at most " + std::to_string(limits.max_side) + " pixels a side and " +
               std::to_string(limits.max_pixels) + " in all, found " + std::to_string(width) + " x " +
               std::to_string(height);
    return {};
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
    if (const std::string why = check_size(spec, limits); !why.empty()) return why;

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

void add_attributes(io::ImageSpec& spec, const PluginAttributes& attributes, bool numbers_as_text) {
    for (const auto& [name, text] : attributes.texts) spec.attribute(name, text);
    for (const auto& [name, number] : attributes.numbers) {
        if (numbers_as_text) {
            std::array<char, 32> text{};
            const auto end = std::to_chars(text.data(), text.data() + text.size(), number).ptr;
            spec.attribute(name, std::string(text.data(), end));
        } else {
            spec.attribute(name, number);
        }
    }
}

std::string write_to_memory(const char* name, const io::ImageSpec& spec, io::TypeDesc type, const void* values,
                            Bytes& out) {
    io::Filesystem::IOVecOutput sink(out);
    const auto output = io::ImageOutput::create(name, &sink);
    if (!output) return first_line(io::geterror(), "this kind of picture is not supported");
    if (!output->open(name, spec) || !output->write_image(type, values) || !output->close())
        return first_line(output->geterror(), "the encoder failed");
    return {};
}

io::TypeDesc type_of(ExrSample sample) {
    if (sample == ExrSample::uint_32) return io::TypeUInt32;
    return sample == ExrSample::half_float ? io::TypeHalf : io::TypeFloat;
}

io::ImageSpec exr_spec(std::uint32_t width, std::uint32_t height, const std::vector<std::string>& channels, ExrSample sample,
                       const PluginAttributes& attributes) {
    io::ImageSpec spec(static_cast<int>(width), static_cast<int>(height), static_cast<int>(channels.size()), type_of(sample));
    spec.channelnames = channels;
    spec.attribute("compression", "zip");
    spec.attribute("oiio:ColorSpace", "Linear");
    spec.attribute("DateTime", "1970:01:01 00:00:00");  // else the time of writing: other bytes each time
    add_attributes(spec, attributes, false);
    return spec;
}

std::string write_exr(const ImageView& image, ExrSample sample, const PluginAttributes& attributes, Bytes& out) {
    return guarded([&] {
        const io::ImageSpec spec = exr_spec(image.width, image.height, image.channels, sample, attributes);
        return write_to_memory("memory.exr", spec, io::TypeFloat, image.values.data(), out);
    });
}

/// A file without a place on any disk. The library writes parts only to files that have a name.
class MemoryFile {
  public:
    MemoryFile() : descriptor_(::memfd_create("luxel", MFD_CLOEXEC)) {}
    ~MemoryFile() {
        if (descriptor_ >= 0) ::close(descriptor_);
    }
    MemoryFile(const MemoryFile&) = delete;
    MemoryFile& operator=(const MemoryFile&) = delete;
    [[nodiscard]] bool is_open() const { return descriptor_ >= 0; }
    [[nodiscard]] std::string name() const { return "/proc/self/fd/" + std::to_string(descriptor_); }
    bool read(Bytes& out) const {
        struct stat status {};
        if (::fstat(descriptor_, &status) != 0) return false;
        out.resize(static_cast<std::size_t>(status.st_size));
        for (std::size_t done = 0; done < out.size();) {
            const ssize_t got = ::pread(descriptor_, out.data() + done, out.size() - done, static_cast<off_t>(done));
            if (got < 0 && errno == EINTR) continue;
            if (got <= 0) return false;
            done += static_cast<std::size_t>(got);
        }
        return true;
    }

  private:
    int descriptor_;
};

/// Can the last line of every part be read? The library's encoder does not tell when the end of a file gets lost.
bool is_whole(const Bytes& file, const std::vector<io::ImageSpec>& specs) {
    io::Filesystem::IOMemReader source(const_cast<std::uint8_t*>(file.data()), file.size());
    const auto input = io::ImageInput::open("memory.exr", nullptr, &source);
    if (!input) return false;
    for (std::size_t part = 0; part < specs.size(); ++part) {
        const io::ImageSpec& spec = specs[part];
        std::vector<std::uint32_t> line(static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(spec.nchannels));
        const io::TypeDesc type = spec.format == io::TypeUInt32 ? io::TypeUInt32 : io::TypeFloat;
        if (!input->read_scanlines(static_cast<int>(part), 0, spec.height - 1, spec.height, 0, 0, spec.nchannels, type, line.data()))
            return false;
    }
    return true;
}

std::string write_exr_parts(std::uint32_t width, std::uint32_t height, std::span<const PluginPart> parts,
                            const std::function<const void*(std::size_t)>& values, Bytes& out) {
    return guarded([&]() -> std::string {
        std::vector<io::ImageSpec> specs;
        for (const PluginPart& part : parts) {
            specs.push_back(exr_spec(width, height, part.channels, part.sample, part.attributes));
            specs.back().attribute("oiio:subimagename", part.name);
        }
        const MemoryFile file;
        const auto output = io::ImageOutput::create("memory.exr");
        if (!file.is_open() || !output) return first_line(io::geterror(), "no memory for the file");
        const std::string name = file.name();
        if (!output->open(name, static_cast<int>(specs.size()), specs.data())) return first_line(output->geterror(), "the encoder failed");
        for (std::size_t part = 0; part < parts.size(); ++part) {
            if (part > 0 && !output->open(name, specs[part], io::ImageOutput::AppendSubimage))
                return first_line(output->geterror(), "the encoder failed");
            const void* samples = values(part);
            if (!samples) return "its values are missing";
            if (!output->write_image(parts[part].sample == ExrSample::uint_32 ? io::TypeUInt32 : io::TypeFloat, samples))
                return first_line(output->geterror(), "the encoder failed");
        }
        if (!output->close()) return first_line(output->geterror(), "the encoder failed");
        return file.read(out) && is_whole(out, specs) ? "" : "the encoder lost a part of the file: files of this size may not be allowed here";
    });
}

std::string write_png(std::uint32_t width, std::uint32_t height, std::span<const std::uint8_t> rgb,
                      const PluginAttributes& attributes, Bytes& out) {
    return guarded([&] {
        io::ImageSpec spec(static_cast<int>(width), static_cast<int>(height), 3, io::TypeUInt8);
        add_attributes(spec, attributes, true);
        return write_to_memory("memory.png", spec, io::TypeUInt8, rgb.data(), out);
    });
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
    static const luxel::ImagePlugin plugin{luxel::image_plugin_version, luxel::decode, luxel::write_exr,
                                           luxel::write_exr_parts, luxel::write_png};
    return configured ? &plugin : nullptr;
}
