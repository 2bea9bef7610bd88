/// What the sample patterns of a texel depend on: the chart's object, the place on the chart's own grid and the seed of the bake. Packing does
/// not change the noise. Threads: a pure function.
#pragma once
#include <cstdint>

#include "baker/core/sobol.h"
#include "baker/patches/texels.h"
#include "baker/scene/scene.h"
#include "baker/unwrap/atlas.h"

namespace luxel {

inline std::uint64_t texel_seed(const Scene& scene, const Atlas& atlas, const Texel& texel, std::uint64_t seed) {
    const Chart& chart = atlas.charts[texel.chart];
    const Object& object = scene.objects[chart.object];
    const std::uint64_t place = (std::uint64_t{texel.y - chart.y} << 32) | (texel.x - chart.x);
    return mix(mix(mix(object.path_hash, chart.ordinal), place), seed ^ 0x746578656cULL);
}

}  // namespace luxel
