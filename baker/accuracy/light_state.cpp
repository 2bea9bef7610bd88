#include "baker/accuracy/light_state.h"

#include "formats/base/error.h"

namespace luxel {

void check(const LightState& light) {
    const std::size_t count = light.ids.size();
    if (light.area_m2.size() != count || light.reflectance.size() != count || light.radiosity.size() != count ||
        light.irradiance.size() != count || light.mu.size() != count || light.open_m2.size() != count)
        throw Error(ErrorCode::internal, "accuracy", "all arrays need one entry per patch");
}

}  // namespace luxel
