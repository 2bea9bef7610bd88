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

/// Fills scene.materials (one per record, and a last one for "no material") and scene.textures. `least_alpha`: per material the
/// least alpha of the vertices that show it; none where nothing does: images of those are not decoded.
void build_materials(const SceneRecord& record, const std::vector<std::optional<float>>& least_alpha, const ImageDecoder& decode,
                     const BuildOptions& options, Scene& scene, std::vector<Warning>& warnings);

/// Fills scene.lamps; needs scene.origin. Lamps without a place or a direction are left out with a warning.
void build_lamps(const SceneRecord& record, const BuildOptions& options, Scene& scene, std::vector<Warning>& warnings);

}  // namespace luxel
