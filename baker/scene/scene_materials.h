/// Materials, textures and lamps of a Scene. Parts of scene_build.
///
/// Units    reflectance 0..1; emission as exitance M = pi * nits in lm/m2; lamps in cd or lux, metres from the origin.
/// Metals   reflect their base colour diffusely: lightmaps know no mirrors.
/// Panes    transmission t passes its share of the light (see_through.h); what emits passes none by it (a warning says so), and
///          reflects 1 - t. Alpha that covers everywhere becomes AlphaMode::opaque.
/// Threads  pure functions but for `warnings`.
#pragma once
#include "baker/scene/scene_build.h"

namespace luxel {

/// Fills scene.materials (one per record, and a last one for "no material") and scene.textures, of those materials for
/// which used[m] is true: images of the others are not decoded.
void build_materials(const SceneRecord& record, const std::vector<bool>& used, const ImageDecoder& decode,
                     const BuildOptions& options, Scene& scene, std::vector<Warning>& warnings);

/// Fills scene.lamps; needs scene.origin. Lamps without a place or a direction are left out with a warning.
void build_lamps(const SceneRecord& record, const BuildOptions& options, Scene& scene, std::vector<Warning>& warnings);

}  // namespace luxel
