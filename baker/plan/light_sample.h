/// How long the light of a texel takes: that of some texels is gathered as the bake will do it, but for what it reads there.
#pragma once
#include "baker/bake/geometry_stages.h"

namespace luxel {

/// Seconds per texel on all of the bake's threads if no other program runs, at `options.gather_rays`; 0 where nothing is gathered. Takes at most 1024 texels,
/// spread evenly. Threads: uses them all.
double sample_light(const BakeOptions& options, const BakedGeometry& geometry);

}  // namespace luxel
