/// The light of one texel in its parts, for layers beside the lightmap (baker/output/layers.h). One per texel of a
/// page, in texel order.
#pragma once
#include <cstdint>

#include "baker/core/vec.h"

namespace luxel {

struct TexelLight {
    Rgb direct{0, 0, 0};    ///< irradiance straight from lamps, the sky and the emission of surfaces, lux
    Rgb indirect{0, 0, 0};  ///< irradiance by way of at least one reflection, lux
    /// Estimated error of the luminance of direct + indirect, relative to that luminance; >= 0: the noise that is left, and `bias`, as the
    /// root of the sum of their squares. 0 where nothing of it was estimated, or where it is dark.
    float error = 0;
    float bias = 0;  ///< of it, what sharing with neighbours is likely to have changed (light/share_light.h)
    std::uint32_t rays = 0;  ///< that left this texel and the points near it to gather light; shadow rays to lamps are not counted

    /// What the lightmap holds, lux.
    [[nodiscard]] Rgb irradiance() const { return direct + indirect; }
};

}  // namespace luxel
