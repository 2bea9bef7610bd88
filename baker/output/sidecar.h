/// The list of what a bake wrote, as `<out>.lightmaps.json` beside the glTF: for tools that want the float pages
/// instead of the model's pictures, or that do not read MOZ_lightmap.
///
///     { "schema": 1, "generator": "luxel 0.1.0", "model": "hall.glb", "texCoord": 1, "texelsPerMetre": 16,
///       "pages": [ { "index": 0, "width": 1024, "height": 1024, "quantity": "irradiance", "unit": "lux",
///                    "exr": { "uri": "hall.lightmap0.exr", "encoding": "linear", "intensity": 1 },
///                    "picture": { "name": "lightmap0.srgb8", "uri": "hall.lightmap0.png", "format": "png8",
///                                 "encoding": "srgb8", "intensity": 41.25,
///                                 "error": { "median": 0.004, "p95": 0.02, "largest": 0.0046 } },
///                    "png": { ... },
///                    "layers": { "uri": "hall.aov0.exr", "parts": [
///                        { "name": "albedo", "channels": "RGB", "quantity": "reflectance" } ] } } ] }
///
/// `picture`: what the model's textures hold, in any format (page_picture.h), with `range` where its decoding needs one, and how far it is from
/// `exr`; `png`: the same again where the format is a PNG, for readers of the time when all of them were.
/// `profile`: for which viewers the model is made (viewer_profile.h): of `mx` nodes name the pages, of others materials. It changes the intensities there, never the ones here.
/// `layers`: further layers of the page (layers.h), each a part of that name in one OpenEXR file; a part without `unit` is a number.
/// Pages that are not final have a member `state` after `generator`: "preview", or "stopped" by the user.
/// A value in `unit` is decode(sample) * intensity (docs/lightmap-formats.md). `uri` is relative to the sidecar and percent-encoded; absent when
/// the picture is only inside the model, where `name` finds it among the glTF images. `schema` is raised when a member
/// changes its meaning; members may be added without that.
///
/// Errors   Error{cannot_write}. Published whole or not at all. The same input gives the same bytes.
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "baker/output/layers.h"
#include "baker/output/picture_error.h"
#include "formats/base/bytes.h"

namespace luxel {

struct SidecarPicture {
    std::string file;  ///< name of the file beside the sidecar; empty: only inside the model
    std::string name;  ///< of the image in the model; empty: not in the model
    std::string encoding;
    double intensity = 1;
    std::string format{};  ///< empty: left out
    double range = 0;      ///< 0: left out
    std::optional<PictureError> error{};
};

struct SidecarPage {
    std::uint32_t width = 0, height = 0;
    std::string quantity = "irradiance", unit = "lux";
    SidecarPicture exr, picture;  ///< left out where both names are empty
    std::string layer_file;   ///< name of the file beside the sidecar that holds `layers`; empty: there is none
    std::vector<Layer> layers;
};

struct Sidecar {
    std::string generator;  ///< name and version
    std::string state;      ///< "preview" while the light is being solved, "stopped" where that was cut short; empty: final
    std::string model;      ///< file name of the glTF
    std::string profile;    ///< empty: left out
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
