/// What the user and the file say of the sky -> Scene::sky. Part of scene_build.
///
/// Light      nits. EXT_lights_image_based calls its unit lux, but means what is seen in a direction: it is read as nits.
///            Its PNG pictures are RGBD: sRGB colours divided by alpha, as Babylon.js, whose makers wrote the extension,
///            reads them. JPEG pictures are sRGB.
/// Sizes      pictures wider than most_sky_columns are averaged to at most that width; cubemaps become a picture of four
///            times their side.
/// Findings   light below 0, above most_light (value_check.h) or not a number: as BadValues says, per picture.
#pragma once
#include "baker/scene/scene_build.h"

namespace luxel {

/// 0.18 degrees a pixel: three of them across the sun. 25 MB.
constexpr std::uint32_t most_sky_columns = 2048;

/// Empty: there is none. A sky without any light is one too: it is asked for.
SkyMap build_sky(const SkyRecord& record, const ImageDecoder& decode, const BuildOptions& options,
                 std::vector<Warning>& warnings);

}  // namespace luxel
