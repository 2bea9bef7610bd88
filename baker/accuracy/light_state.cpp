#include "baker/accuracy/light_state.h"

#include <algorithm>

#include "formats/base/error.h"

namespace luxel {

void check(const LightState& light) {
    const std::size_t count = light.ids.size();
    if (light.area_m2.size() != count || light.reflectance.size() != count || light.radiosity.size() != count ||
        light.row_mean.size() != count || light.mu.size() != count || light.open_m2.size() != count || light.neighbourhood.size() != count)
        throw Error(ErrorCode::internal, "accuracy", "all arrays need one entry per patch");
}

bool same_channel(const LightState& light, std::size_t a, std::size_t b) {
    if (light.each_channel) return false;
    for (std::size_t i = 0; i < light.ids.size(); ++i)
        if (light.reflectance[i][static_cast<int>(a)] != light.reflectance[i][static_cast<int>(b)] ||
            light.radiosity[i][a] != light.radiosity[i][b])
            return false;
    return true;
}

bool is_dark(const LightState& light, std::size_t c) {
    return std::all_of(light.radiosity.begin(), light.radiosity.end(), [c](const Channels& b) { return b[c] == 0; });
}

}  // namespace luxel
