/// The list of what a bake wrote, as `<out>.lightmaps.json` beside the glTF: for tools that want the float pages
/// instead of the 8-bit ones, or that do not read MOZ_lightmap.
///
///     { "schema": 1, "generator": "luxel 0.1.0", "model": "hall.glb", "texCoord": 1, "texelsPerMetre": 16,
///       "pages": [ { "index": 0, "width": 1024, "height": 1024, "quantity": "irradiance", "unit": "lux",
///                    "exr": { "uri": "hall.lightmap0.exr", "encoding": "linear", "intensity": 1 },
///                    "png": { "name": "lightmap0.srgb8", "uri": "hall.lightmap0.png", "encoding": "srgb8",
///                             "intensity": 41.25 },
///                    "layers": { "uri": "hall.aov0.exr", "parts": [
///                        { "name": "albedo", "channels": "RGB", "quantity": "reflectance" } ] } } ] }
///
/// `layers`: further layers of the page (layers.h), each a part of that name in one OpenEXR file; a part without `unit` is a number.
/// Pages that are not final have a member `state` after `generator`: "preview", or "stopped" by the user.
/// A value in `unit` is decode(sample) * intensity. `uri` is relative to the sidecar and percent-encoded; absent when
/// the picture is only inside the model, where `name` finds it among the glTF images. `schema` is raised when a member
/// changes its meaning; members may be added without that.
///
/// Errors   Error{cannot_write}. Published whole or not at all. The same input gives the same bytes.
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "baker/output/layers.h"
#include "formats/base/bytes.h"

namespace luxel {

struct SidecarPicture {
    std::string file;  ///< name of the file beside the sidecar; empty: only inside the model
    std::string name;  ///< of the image in the model; empty: not in the model
    std::string encoding;
    double intensity = 1;
};

struct SidecarPage {
    std::uint32_t width = 0, height = 0;
    std::string quantity = "irradiance", unit = "lux";
    SidecarPicture exr, png;  ///< left out where both names are empty
    std::string layer_file;   ///< name of the file beside the sidecar that holds `layers`; empty: there is none
    std::vector<Layer> layers;
};

struct Sidecar {
    std::string generator;  ///< name and version
    std::string state;      ///< "preview" while the light is being solved, "stopped" where that was cut short; empty: final
    std::string model;      ///< file name of the glTF
    int uv_set = 1;
    double texels_per_metre = 0;
    std::vector<SidecarPage> pages;
};

/// "hall.glb" -> "hall.glb.lightmaps.json".
std::filesystem::path sidecar_path(const std::filesystem::path& model);
/// UTF-8 JSON, indented by two, with a final line feed.
Bytes sidecar_text(const Sidecar& sidecar);
void write_sidecar(const std::filesystem::path& path, const Sidecar& sidecar);

}  // namespace luxel
