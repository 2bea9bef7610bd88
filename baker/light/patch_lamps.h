/// Direct light of lamps per patch: what the solve treats as light that the patch reflects.
#pragma once
#include <vector>

#include "baker/light/lamps.h"
#include "baker/patches/patch.h"
#include "baker/unwrap/atlas.h"

namespace luxel {

/// Mean irradiance over each patch, lux; zero without lamps. Lamps are tested at `points` of each, or fewer where `few_points` find no edge
/// of a shadow (surface_lamps.h); both powers of two. Much light of a room may come from one small sunlit place: what is wrong there is
/// wrong everywhere.
/// Threads: uses them all; a pure function of geometry, lamps and stable ids.
std::vector<Rgb> patch_lamp_irradiance(const Scene& scene, const Atlas& atlas, const PatchSet& patches,
                                       const Tracer& tracer, std::uint32_t few_points, std::uint32_t points);

}  // namespace luxel
