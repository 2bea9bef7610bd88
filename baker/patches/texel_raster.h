/// Atlas -> TexelSet: which texels each triangle covers, and how much of it lies in each.
///
/// Conservative: a texel that a triangle touches with any area gets a fragment. Areas are exact: the fragments of a
/// triangle add up to it (rounding of floats aside), also for slivers and triangles without area on the page.
/// Threads: parallel inside; the result does not depend on it. Errors: none on a valid atlas.
#pragma once
#include "baker/patches/texels.h"
#include "baker/scene/scene.h"
#include "baker/unwrap/atlas.h"

namespace luxel {

TexelSet raster_texels(const Scene& scene, const Atlas& atlas);

}  // namespace luxel
