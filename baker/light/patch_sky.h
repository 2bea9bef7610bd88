/// Light of the sky per patch: what the solve treats as light that the patch reflects, beside that of lamps.
#pragma once
#include <span>
#include <vector>

#include "baker/formfactors/sky_bins.h"
#include "baker/patches/patch.h"
#include "baker/trace/tracer.h"
#include "baker/unwrap/atlas.h"

namespace luxel {

/// Irradiance of one patch by the binned part, lux: pi / rays * sum of count * radiance. `bins` and `counts`: what its open rays
/// went into (formfactors/sky_view.h).
Rgb binned_irradiance(std::span<const Rgb> bin_nits, std::span<const SkyBin> bins, std::span<const std::uint16_t> counts,
                      std::uint32_t rays);

/// Adds the mean irradiance by the bright part to each patch: `points` places of the patch (a power of two), from each a
/// shadow ray towards the bright part. Exact in the mean. Threads: uses them all; a pure function of geometry, sky and
/// stable ids.
void add_bright_sky(const Scene& scene, const Atlas& atlas, const PatchSet& patches, const Tracer& tracer, const SkyMap& bright,
                    std::uint32_t points, std::vector<Rgb>& irradiance);

}  // namespace luxel
