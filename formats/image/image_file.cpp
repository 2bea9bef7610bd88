#include "formats/image/image_file.h"

#include <dlfcn.h>

#include <array>
#include <atomic>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string_view>

#include "formats/image/codec.h"
#include "formats/image/exr_file.h"
#include "formats/image/hdr_file.h"
#include "formats/image/image_plugin.h"
#include "formats/image/jpeg_file.h"
#include "formats/image/ktx2_file.h"
#include "formats/image/png_file.h"

namespace luxel {
namespace {

constexpr const char* module_name = "luxel_image_plugin.so";
std::atomic<bool> module_is_loaded{false};

std::vector<std::filesystem::path> module_folders() {
    std::vector<std::filesystem::path> folders;
    if (const char* chosen = std::getenv("LUXEL_PLUGIN_DIR")) return {chosen};
    std::error_code unknown;
    const auto program = std::filesystem::read_symlink("/proc/self/exe", unknown);
    if (!unknown) {
        folders.push_back(program.parent_path());
        folders.push_back(program.parent_path() / ".." / "lib" / "luxel");
    }
    folders.emplace_back(LUXEL_PLUGIN_BUILD_DIR);
    return folders;
}

const ImagePlugin* load_module() {
    std::string tried;
    for (const auto& folder : module_folders()) {
        const auto path = folder / module_name;
        tried += (tried.empty() ? "" : ", ") + folder.string();
        std::error_code ignored;
        if (!std::filesystem::exists(path, ignored)) continue;
        void* handle = ::dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
        if (!handle)
            throw Error(ErrorCode::not_in_build, path.string(), std::string("cannot load: ") + ::dlerror(),
                        "install OpenImageIO, or build this program again");
        const auto entry = reinterpret_cast<ImagePluginEntry>(::dlsym(handle, image_plugin_entry));
        const ImagePlugin* plugin = entry ? entry() : nullptr;
        if (!plugin || plugin->version != image_plugin_version) {
            ::dlclose(handle);
            throw Error(ErrorCode::not_in_build, path.string(),
                        "expected version " + std::to_string(image_plugin_version) + " of the image module, found " +
                            (plugin ? std::to_string(plugin->version) : std::string("another library")),
                        "keep the program and its modules from one build together");
        }
        module_is_loaded = true;
        return plugin;  // never closed: the library keeps threads and tables of its own
    }
    throw Error(ErrorCode::not_in_build, module_name, "not found; looked in " + tried,
                "set LUXEL_PLUGIN_DIR to the folder that holds it");
}

const ImagePlugin& plugin() {
    static std::mutex guard;
    static const ImagePlugin* loaded = nullptr;
    const std::lock_guard lock(guard);
    if (!loaded) loaded = load_module();
    return *loaded;
}

/// The reader for these bytes by their first bytes; names and mime types of scenes are often wrong. nullptr: none.
const char* extension_of(ByteView bytes) {
    const auto begins = [&](std::string_view magic, std::size_t at = 0) {
        return bytes.size() >= at + magic.size() && std::memcmp(bytes.data() + at, magic.data(), magic.size()) == 0;
    };
    if (begins("\x89PNG\r\n\x1a\n")) return "png";
    if (begins("\xff\xd8\xff")) return "jpg";
    if (begins("RIFF") && begins("WEBP", 8)) return "webp";
    if (begins("#?RADIANCE") || begins("#?RGBE")) return "hdr";
    if (begins("\x76\x2f\x31\x01")) return "exr";
    return nullptr;
}

/// Nothing: only the module reads it.
std::optional<std::string> decode_without_module(ByteView bytes, std::string_view extension, const ImageLimits& limits, ImagePixels& out) {
    if (extension == "png") return decode_png(bytes, limits, out);
    if (extension == "jpg") return decode_jpeg(bytes, limits, out);
    if (extension == "exr") return decode_exr(bytes, limits, out);
    return std::nullopt;
}

}  // namespace

ImagePixels decode_image(ByteView bytes, const std::string& where, const ImageLimits& limits) {
    const char* extension = extension_of(bytes);
    if (!extension)
        throw Error(ErrorCode::bad_input, where, "expected PNG, JPEG, WebP, HDR or EXR, found another kind of file",
                    "convert the picture to one of these");
    ImagePixels image;
    std::optional<std::string> why = decode_without_module(bytes, extension, limits, image);
    if (!why) why = plugin().decode(bytes, extension, limits, image);
    if (!why->empty())
        throw Error(ErrorCode::bad_input, where, "cannot decode as " + std::string(extension) + ": " + *why,
                    "open and save the picture again with another program");
    return image;
}

namespace {

/// Runs a step of an encoder. What the encoder throws becomes an Error.
template <class Step>
auto encoding_exr(const Step& step) -> decltype(step()) {
    try {
        return step();
    } catch (const std::bad_alloc&) {
        throw Error(ErrorCode::cannot_write, "OpenEXR picture", "cannot encode: not enough memory");
    } catch (const std::exception& error) {
        throw Error(ErrorCode::cannot_write, "OpenEXR picture", std::string("cannot encode: ") + error.what());
    }
}

/// The samples of a part after a check of their kind and number.
const void* checked_samples(const ExrPartValues& values, const ExrPart& part, std::uint64_t count) {
    const void* samples = nullptr;
    std::uint64_t found = 0;
    if (const auto* floats = std::get_if<std::vector<float>>(&values); floats && part.sample != ExrSample::uint_32)
        samples = floats->data(), found = floats->size();
    if (const auto* numbers = std::get_if<std::vector<std::uint32_t>>(&values); numbers && part.sample == ExrSample::uint_32)
        samples = numbers->data(), found = numbers->size();
    if (found != count)
        throw Error(ErrorCode::internal, "encode_exr_parts", "part " + part.name + " is not width * height * channels values of its kind");
    return samples;
}

}  // namespace

Bytes encode_exr(const ImageView& image, ExrSample sample, const ImageMetadata& metadata) {
    if (image.values.size() != std::uint64_t{image.width} * image.height * image.channels.size() ||
        image.values.empty())
        throw Error(ErrorCode::internal, "encode_exr", "the number of values is not width * height * channels");
    return encoding_exr([&] {
        const ExrPart part{"", image.channels, sample, metadata};
        ExrWriter writer(image.width, image.height, {&part, 1});
        writer.write(0, image.values.data());
        return writer.finish();
    });
}

Bytes encode_exr_parts(std::uint32_t width, std::uint32_t height, std::span<const ExrPart> parts,
                       const std::function<ExrPartValues(std::size_t part)>& values) {
    if (parts.empty() || width == 0 || height == 0) throw Error(ErrorCode::internal, "encode_exr_parts", "there is nothing to encode");
    const auto writer = encoding_exr([&] { return std::make_unique<ExrWriter>(width, height, parts); });
    for (std::size_t part = 0; part < parts.size(); ++part) {
        const ExrPartValues held = values(part);
        const void* samples = checked_samples(held, parts[part], std::uint64_t{width} * height * parts[part].channels.size());
        encoding_exr([&] { writer->write(part, samples); });
    }
    return encoding_exr([&] { return writer->finish(); });
}

ExrSample exr_sample_for(std::span<const float> values) {
    constexpr float half_max = 65504.0f, half_min_normal = 6.103515625e-5f, negligible = 5.9604645e-8f;
    float largest = 0;
    for (const float value : values) largest = std::max(largest, std::abs(value));
    if (!(largest <= half_max)) return ExrSample::float_32;
    const float floor = largest * negligible;
    for (const float value : values) {
        const float size = std::abs(value);
        if (size > floor && size < half_min_normal) return ExrSample::float_32;
    }
    return ExrSample::half_float;
}

namespace {

/// Name and text of all metadata, in the order in which files hold them.
std::vector<std::pair<std::string, std::string>> texts_of(const ImageMetadata& metadata) {
    std::array<char, 32> intensity{};
    const auto end = std::to_chars(intensity.data(), intensity.data() + intensity.size(), static_cast<float>(metadata.intensity)).ptr;
    std::vector<std::pair<std::string, std::string>> texts{
        {"quantity", metadata.quantity}, {"unit", metadata.unit}, {"encoding", metadata.encoding}, {"Software", metadata.software}};
    texts.insert(texts.end(), metadata.more.begin(), metadata.more.end());
    texts.emplace_back("intensity", std::string(intensity.data(), end));
    return texts;
}

void check_samples(const char* where, std::uint32_t width, std::uint32_t height, std::uint64_t channels, std::size_t found) {
    if (found != std::uint64_t{width} * height * channels || found == 0)
        throw Error(ErrorCode::internal, where, "the number of samples is not width * height * " + std::to_string(channels));
}

Bytes encoded_png(const PngSamples& samples, const ImageMetadata& metadata) {
    Bytes bytes;
    const std::string why = write_png(samples, texts_of(metadata), bytes);
    if (!why.empty()) throw Error(ErrorCode::cannot_write, "PNG picture", "cannot encode: " + why);
    return bytes;
}

}  // namespace

Bytes encode_png(std::uint32_t width, std::uint32_t height, std::span<const std::uint8_t> rgb,
                 const ImageMetadata& metadata) {
    check_samples("encode_png", width, height, 3, rgb.size());
    return encoded_png({width, height, 3, 8, rgb.data()}, metadata);
}

Bytes encode_png_rgba(std::uint32_t width, std::uint32_t height, std::span<const std::uint8_t> rgba, const ImageMetadata& metadata) {
    check_samples("encode_png_rgba", width, height, 4, rgba.size());
    return encoded_png({width, height, 4, 8, rgba.data()}, metadata);
}

Bytes encode_png_16(std::uint32_t width, std::uint32_t height, std::span<const std::uint16_t> rgb, const ImageMetadata& metadata) {
    check_samples("encode_png_16", width, height, 3, rgb.size());
    return encoded_png({width, height, 3, 16, reinterpret_cast<const std::uint8_t*>(rgb.data())}, metadata);
}

Bytes encode_hdr(std::uint32_t width, std::uint32_t height, std::span<const std::uint8_t> rgbe, const ImageMetadata& metadata) {
    check_samples("encode_hdr", width, height, 4, rgbe.size());
    return write_hdr(width, height, rgbe, texts_of(metadata));
}

Bytes encode_ktx2(std::uint32_t width, std::uint32_t height, std::span<const std::uint16_t> rgba, const ImageMetadata& metadata) {
    check_samples("encode_ktx2", width, height, 4, rgba.size());
    return write_ktx2(width, height, rgba, texts_of(metadata));
}

bool image_library_is_loaded() { return module_is_loaded; }

}  // namespace luxel
