/// What every texel sends: a first gathering with few rays per texel, read by the rays of the second (light/radiosity_detail.h). Patches
/// of few texels, and those whose texels' halves differ by more than a quarter of what they send, get up to 16 times as many.
/// Threads: uses them all.
#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "baker/bake/bake.h"
#include "baker/bake/geometry_stages.h"
#include "baker/light/gather.h"
#include "baker/light/radiosity_detail.h"

namespace luxel {

struct FirstGathering {
    RadiosityDetail radiosity;
    std::uint64_t rays = 0;  ///< that were traced for it, TexelLight::rays of all texels
};

/// `input.radiosity` is what these rays read. `reflected`: B - M per patch number, lm/m2, of patches without texels. None: there was no
/// time for it. A pure function but for `BakeOptions::stop`.
std::optional<FirstGathering> first_gathering(const BakeOptions& options, const BakedGeometry& geometry, const GatherInput& input,
                                              std::vector<Rgb> reflected);

}  // namespace luxel
