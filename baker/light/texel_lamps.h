/// Light of lamps at the texels of a page: a few points of each texel everywhere, many where the texels beside it show that the edge
/// of a shadow may run through it, or where lamps are so many that a few points tell little.
///
/// Which texels get many points, only their neighbours decide: so no value decides about itself (surface_lamps.h).
///
/// Errors: none. Threads: uses them all; a pure function of geometry, lamps and options.
#pragma once
#include <optional>
#include <span>
#include <vector>

#include "baker/core/stop.h"
#include "baker/patches/texels.h"
#include "baker/trace/tracer.h"
#include "baker/unwrap/atlas.h"

namespace luxel {

struct TexelLampOptions {
    std::uint32_t points = 4;       ///< of a texel at which lamps are tested, a power of two
    std::uint32_t edge_points = 0;  ///< where an edge may be, a power of two; 0: as everywhere
    std::uint64_t seed = 0;
    const StopRequest* stop = nullptr;  ///< looked at before each texel
};

/// Irradiance per texel, lux, in the order of the page's texels; 0 where no light can be gathered. `other`: luminance of what they
/// get besides, lux: beside a bright light the edge of a dim shadow does not matter. Nothing when it was asked to stop.
std::optional<std::vector<Rgb>> texel_lamps(const Scene& scene, const Atlas& atlas, const PageTexels& page, std::uint32_t page_size,
                                            const Tracer& tracer, std::span<const float> other, const TexelLampOptions& options);

}  // namespace luxel
