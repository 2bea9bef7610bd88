/// What a texel is on the average: sums and means over its fragments.
/// Threads: one call per texel at a time. Errors: none.
#pragma once
#include "baker/patches/texels.h"
#include "baker/scene/scene.h"
#include "baker/unwrap/atlas.h"

namespace luxel {

/// Fills area_m2, visible_m2, reflectance and emission of a texel of `page` from its fragments (not empty). Textures are
/// averaged per fragment as a whole; the mean over fragments counts what is visible of each, and what lets light through by
/// its opacity (see_through_texels.h).
void average_texel(const Scene& scene, const Atlas& atlas, const PageTexels& page, Texel& texel);

}  // namespace luxel
