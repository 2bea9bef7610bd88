/// What every texel sends: a first gathering with few rays per texel, read by the rays of the second (light/radiosity_detail.h). Patches
/// of few texels, and those whose texels' halves differ by more than a quarter of what they send, get up to 16 times as many.
/// Its own rays read patches. Where many rays per texel ask for more, a second round reads the texels of the first: then one bounce
/// more has the detail of texels.
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

/// How many there are, each to read what the one before it has found.
std::uint32_t first_rounds(const BakeOptions& options);

/// Round `round`, 0 the first. `input.radiosity` is what these rays read. `reflected`: B - M per patch number, lm/m2, of patches without
/// texels. None: there was no time for it. A pure function but for `BakeOptions::stop`.
std::optional<FirstGathering> first_gathering(const BakeOptions& options, std::uint32_t round, const BakedGeometry& geometry,
                                              const GatherInput& input, std::vector<Rgb> reflected);

}  // namespace luxel
