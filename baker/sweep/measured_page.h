/// Pages of a bake as a sweep reads them back: what `luxel bake` wrote, with the layers `valid` and `area` (docs/layers.md).
///
/// Threads  pure.  Errors  Error{bad_input} naming the file: not a picture, a layer is missing, sizes that differ.
#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace luxel {

struct PageLight {
    std::uint32_t width = 0, height = 0;
    std::vector<std::array<float, 3>> lux;  ///< per texel, row 0 at the top
};

struct MeasuredPage {
    PageLight light;
    std::vector<float> area_m2;  ///< of texels that have light of their own; 0 elsewhere
    std::vector<float> error;    ///< as luxel believes it to be, relative; empty: it does not know
};

/// Any picture of floats.
PageLight read_page_light(const std::filesystem::path& path);

/// Page `number` of the bake that wrote `model`, with the layer `error` if it is there.
MeasuredPage read_measured_page(const std::filesystem::path& model, std::uint32_t number, bool has_error);

/// "out/scene.glb", 0 -> "out/scene.lightmap0.exr", "out/scene.aov0.exr"
std::filesystem::path page_path(const std::filesystem::path& model, std::uint32_t number);
std::filesystem::path layers_path(const std::filesystem::path& model, std::uint32_t number);

}  // namespace luxel
