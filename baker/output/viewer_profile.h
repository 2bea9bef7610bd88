/// For which viewers a model is made: they disagree about the factor pi, about the colour space of lightmaps, and about who names a lightmap,
/// materials or nodes. docs/lightmap-formats.md has the table.
///
///   three  texel * intensity = E in lux, the viewer shows reflectance / pi * E: three.js, also for unlit materials. 8 bits: sRGB.
///   hubs   the Hubs client: as three for lit materials; for unlit ones it multiplies the intensity by pi, so they get E / pi. It takes
///          textures of lightmaps as linear, so 8 bits are linear8; HDR is RGBE inside the GLB, as it loads a single file.
///   plain  texel * intensity = E / pi, what base colour is multiplied by. 8 bits: sRGB.
///   mx     Third Room and what else reads MX_lightmap: nodes name the lightmap, texel * intensity = E / pi (its viewer multiplies the intensity by pi,
///          where its three.js divides), always as rgbm-mx. It shows no lightmaps on unlit materials.
///
/// Threads  pure.
/// Source   three.js, lights_fragment_maps and meshbasic shaders since r145; Hubs-Foundation/hubs, src/components/gltf-model-plus.js
///          (GLTFHubsLightMapExtension, GLTFMozTextureRGBE), src/systems/environment-system.js (physicallyCorrectLights);
///          matrix-org/thirdroom, docs/gltf/MX_lightmap/README.md, src/engine/mesh/mesh.render.ts, src/engine/material/patchShaderChunks.ts.
#pragma once
#include <array>
#include <optional>
#include <string>

#include "baker/output/lightmap_format.h"

namespace luxel {

enum class ViewerProfile { three, hubs, plain, mx };

struct ViewerProfileInfo {
    ViewerProfile profile;
    const char* name;
    double lit_scale, unlit_scale;   ///< of the intensity that stands for E in lux
    LightmapFormat format;           ///< where the user names none
    LightmapEncoding byte_encoding;  ///< of png8, where the user names none
    bool on_nodes = false;           ///< nodes name their lightmap, materials do not
};

constexpr double inverse_pi = 0.31830988618379067;

constexpr std::array<ViewerProfileInfo, 4> all_viewer_profiles{{
    {ViewerProfile::three, "three", 1, 1, LightmapFormat::png8, LightmapEncoding::srgb8},
    {ViewerProfile::hubs, "hubs", 1, inverse_pi, LightmapFormat::rgbe, LightmapEncoding::linear8},
    {ViewerProfile::plain, "plain", inverse_pi, inverse_pi, LightmapFormat::png8, LightmapEncoding::srgb8},
    {ViewerProfile::mx, "mx", inverse_pi, inverse_pi, LightmapFormat::rgbm_mx, LightmapEncoding::linear8, true},
}};

const ViewerProfileInfo& viewer_profile_info(ViewerProfile profile);
/// Throws Error{usage} naming `where`, with all names.
ViewerProfile parse_viewer_profile(const std::string& name, const std::string& where);

/// Throws Error{usage} where the viewers of a profile cannot show a format or encoding.
void check_profile(ViewerProfile profile, LightmapFormat format, LightmapEncoding byte_encoding);

/// Are pictures that glTF does not know put inside a GLB, although validators then warn of their kind?
bool embeds_foreign_pictures(ViewerProfile profile);

}  // namespace luxel
