#include "baker/sweep/measured_page.h"

#include <string>

#include "formats/base/error.h"
#include "formats/base/file.h"
#include "formats/image/exr_part.h"
#include "formats/image/image_file.h"

namespace luxel {
namespace {

constexpr std::uint32_t valid_own_light = 1;  ///< docs/layers.md

std::filesystem::path beside(std::filesystem::path model, const char* kind, std::uint32_t number) {
    return model.replace_extension(std::string(kind) + std::to_string(number) + ".exr");
}

/// A layer of one channel.
template <class Sample>
std::vector<Sample> read_layer(const Bytes& file, const char* name, const std::filesystem::path& path, const PageLight& page) {
    DecodedExrPart part = decode_exr_part(file, name, path.string());
    auto* values = std::get_if<std::vector<Sample>>(&part.values);
    if (!values || part.channels.size() != 1 || part.width != page.width || part.height != page.height)
        throw Error(ErrorCode::bad_input, path.string(),
                    std::string("layer \"") + name + "\": expected one channel of " + std::to_string(page.width) + " x " + std::to_string(page.height) +
                        ", found " + std::to_string(part.channels.size()) + " of " + std::to_string(part.width) + " x " + std::to_string(part.height),
                    "run the same command again");
    return std::move(*values);
}

}  // namespace

std::filesystem::path page_path(const std::filesystem::path& model, std::uint32_t number) { return beside(model, "lightmap", number); }
std::filesystem::path layers_path(const std::filesystem::path& model, std::uint32_t number) { return beside(model, "aov", number); }

PageLight read_page_light(const std::filesystem::path& path) {
    ImagePixels image = decode_image(read_file(path), path.string());
    if (!image.is_float)
        throw Error(ErrorCode::bad_input, path.string(), "expected a picture of floats, found one of integers", "a reference is linear irradiance in lux, OpenEXR or Radiance HDR");
    PageLight page{image.width, image.height, {}};
    page.lux.reserve(image.pixels.size());
    for (const auto& pixel : image.pixels) page.lux.push_back({pixel[0], pixel[1], pixel[2]});
    return page;
}

MeasuredPage read_measured_page(const std::filesystem::path& model, std::uint32_t number, bool has_error) {
    MeasuredPage page{read_page_light(page_path(model, number)), {}, {}};
    const auto path = layers_path(model, number);
    const Bytes file = read_file(path);
    page.area_m2 = read_layer<float>(file, "area", path, page.light);
    const auto valid = read_layer<std::uint32_t>(file, "valid", path, page.light);
    for (std::size_t at = 0; at < valid.size(); ++at)
        if (valid[at] != valid_own_light) page.area_m2[at] = 0;
    if (has_error) page.error = read_layer<float>(file, "error", path, page.light);
    return page;
}

}  // namespace luxel
