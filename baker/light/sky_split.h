/// A sky as patches use it: a mean per bin of directions, which goes with the counts of open rays that a patch keeps, and
/// what is far brighter than the mean of its bin, such as the sun. That is taken out of the bins, which are 6 degrees wide
/// and would smear it over the scene, and tested with shadow rays of its own.
#pragma once
#include <vector>

#include "baker/scene/scene.h"

namespace luxel {

/// A pixel whose luminance is more than so many times the mean of the rest of its bin is bright.
constexpr double bright_ratio = 4;

struct SkySplit {
    std::vector<Rgb> bins;  ///< sky_bin_count: mean radiance without the bright part, nits
    SkyMap bright;          ///< what the pixels have above that; empty where there is none
};

/// Of the bright part, per pixel of the map. Finding it takes two bytes more, aiming at it takes more than that (Sky::bytes).
constexpr std::uint64_t sky_split_bytes_per_pixel = sizeof(Rgb);

/// bins and bright part together are the sky: their integrals over a bin add up to its. Threads: pure function.
SkySplit split_sky(const SkyMap& map);

}  // namespace luxel
