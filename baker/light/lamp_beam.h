/// What shapes the beam of a lamp beside distance and cosine (KHR_lights_punctual). Units: m; shares are 0..1. Threads: pure functions.
#pragma once
#include <algorithm>

#include "baker/scene/scene.h"

namespace luxel {

/// Of a spot, at this cosine from its axis; 1 of other lamps.
inline float cone_share(const Lamp& lamp, float cosine) {
    if (lamp.kind != LampKind::spot) return 1;
    const float span = std::max(lamp.cos_inner - lamp.cos_outer, 1e-3f);
    const float edge = std::clamp((cosine - lamp.cos_outer) / span, 0.0f, 1.0f);
    return edge * edge;
}

/// At this distance; 1 of lamps without a range.
inline float range_share(const Lamp& lamp, float distance_m) {
    if (!(lamp.range > 0)) return 1;
    const float share = distance_m / lamp.range;
    return std::clamp(1 - share * share * share * share, 0.0f, 1.0f);
}

}  // namespace luxel
