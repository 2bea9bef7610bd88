/// The layers that can be written beside a lightmap: their names, what they mean, and how they are stored.
/// docs/layers.md is for those who read them. Threads: pure.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "formats/image/image_file.h"

namespace luxel {

enum class Layer { direct, indirect, error, sharing, samples, albedo, normal, patch, chart, valid, area };

struct LayerInfo {
    Layer layer;
    const char* name;  ///< on the command line, and of its part in the file
    const char* quantity;
    const char* unit;      ///< empty: a number without one
    const char* channels;  ///< one letter each
    ExrSample sample;
    bool is_of_light;  ///< needs TexelLight; the others are known from geometry and materials
};

/// In the order of the parts of a file. Layers are written as they are: 32 bits each.
constexpr std::array<LayerInfo, 11> all_layers{{
    {Layer::direct, "direct", "irradiance", "lux", "RGB", ExrSample::float_32, true},
    {Layer::indirect, "indirect", "irradiance", "lux", "RGB", ExrSample::float_32, true},
    {Layer::error, "error", "relative error", "", "Y", ExrSample::float_32, true},
    {Layer::sharing, "sharing", "relative error", "", "Y", ExrSample::float_32, true},
    {Layer::samples, "samples", "rays", "", "Y", ExrSample::uint_32, true},
    {Layer::albedo, "albedo", "reflectance", "", "RGB", ExrSample::float_32, false},
    {Layer::normal, "normal", "shading normal", "", "XYZ", ExrSample::float_32, false},
    {Layer::patch, "patch", "number of the patch", "", "Y", ExrSample::uint_32, false},
    {Layer::chart, "chart", "number of the chart", "", "Y", ExrSample::uint_32, false},
    {Layer::valid, "valid", "state of the texel", "", "Y", ExrSample::uint_32, false},
    {Layer::area, "area", "visible area", "m2", "Y", ExrSample::float_32, false},
}};

const LayerInfo& layer_info(Layer layer);

/// All of them: "direct, indirect, ...".
std::string known_layer_names();

/// "albedo,normal" -> the layers named, each once, in the order of all_layers. Throws Error{usage} naming `where`, with
/// all known names, if one is unknown or missing.
std::vector<Layer> parse_layers(const std::string& list, const std::string& where);

/// "albedo,normal", or "none".
std::string layer_names(std::span<const Layer> layers);

/// What writing these layers of a page takes at most, per texel of its square: the light, one layer at a time, and the
/// file twice (encoded, and on its way out).
std::uint64_t layer_bytes_per_texel(std::span<const Layer> layers);

}  // namespace luxel
