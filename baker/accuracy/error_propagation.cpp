#include "baker/accuracy/error_propagation.h"

namespace luxel {

Patterns propagate_errors(BlockSource& source, const LightState& light, std::size_t channel, const Patterns& noise_lm,
                          double tolerance) {
    const Patterns radiosity_error = solve_patterns(source, light, channel, noise_lm, tolerance);
    // One gathering step more: it reaches the patches that reflect nothing, and evens out what the iteration left.
    const PatchSums<pattern_count> gathered = exchange(source, radiosity_error);
    Patterns irradiance_error(gathered.size());
    for (std::size_t i = 0; i < gathered.size(); ++i)
        for (std::size_t v = 0; v < pattern_count; ++v)
            irradiance_error[i][v] =
                static_cast<float>((gathered[i][v] + static_cast<double>(noise_lm[i][v])) / light.area_m2[i]);
    return irradiance_error;
}

}  // namespace luxel
