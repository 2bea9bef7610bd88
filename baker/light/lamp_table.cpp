#include "baker/light/lamp_table.h"

#include <algorithm>

namespace luxel {

LampTable::LampTable(std::span<const Lamp> lamps, const Vec3f& place, float around_m) {
    double total = 0;
    for (std::uint32_t k = 0; k < lamps.size(); ++k) {
        const Lamp& lamp = lamps[k];
        float strength = lamp.intensity.x + lamp.intensity.y + lamp.intensity.z;
        if (lamp.kind != LampKind::directional) {
            const float distance = (lamp.position - place).length();
            if (lamp.range > 0 && distance > lamp.range + around_m) continue;
            const float nearest = std::max(distance, around_m);  // from inside the ball any distance is possible
            strength /= nearest * nearest;
        }
        if (!(strength > 0)) continue;
        total += static_cast<double>(strength);
        entries_.push_back({k, strength, 0});
    }
    double sum = 0;
    for (Entry& entry : entries_) {
        sum += static_cast<double>(entry.probability);
        entry.probability = static_cast<float>(static_cast<double>(entry.probability) / total);
        entry.up_to = static_cast<float>(sum / total);
    }
    if (!entries_.empty()) entries_.back().up_to = 1;
}

LampTable::Choice LampTable::choose(float random) const {
    const auto entry = std::upper_bound(entries_.begin(), entries_.end() - 1, random,
                                        [](float value, const Entry& e) { return value < e.up_to; });
    const float before = entry == entries_.begin() ? 0.0f : (entry - 1)->up_to;
    const float rest = (random - before) / std::max(entry->up_to - before, 1e-30f);
    return {entry->lamp, entry->probability, std::clamp(rest, 0.0f, 0x1.fffffep-1f)};
}

}  // namespace luxel
