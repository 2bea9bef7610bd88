/// Direct light of lamps per patch: what the solve treats as light that the patch reflects.
#pragma once
#include <vector>

#include "baker/light/lamps.h"
#include "baker/patches/patch.h"
#include "baker/unwrap/atlas.h"

namespace luxel {

/// Mean irradiance over each patch, lux; `points` sample points per patch (a power of two). Zero without lamps.
/// Threads: uses them all; a pure function of geometry, lamps and stable ids.
std::vector<Rgb> patch_lamp_irradiance(const Scene& scene, const Atlas& atlas, const PatchSet& patches,
                                       const Tracer& tracer, std::uint32_t points);

}  // namespace luxel
