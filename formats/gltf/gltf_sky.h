/// The image-based light of the scene that is read: EXT_lights_image_based.
///
/// Read     rotation, intensity and the first mip of the cubemap, which is the sky itself. The further mips are that picture
///          blurred, and the irradiance coefficients are the light on a surface that nothing shades: neither says more.
/// Errors   Error{bad_input}: members of a wrong type, indices out of range. Missing pictures are warnings.
/// Source   EXT_lights_image_based. It has each face of the standard cube map flipped about its vertical axis, so that a
///          picture is what an observer in the middle sees: +Y above; above the picture of +Y is -Z, above that of -Y +Z.
#pragma once
#include "formats/gltf/gltf_in.h"

namespace luxel {

/// Fills record.sky, appends warnings.
void read_sky(const GltfDocument& document, const ReadOptions& options, SceneRecord& record);

}  // namespace luxel
