#include "baker/light/lamp_table.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "baker/light/lamp_beam.h"

namespace luxel {
namespace {

/// Of the light without shadows: what the weak lamps together give.
constexpr double weak_share = 0.1;

/// The smallest angle to the axis of a spot at any point of the ball, as a cosine.
float best_cosine(const Lamp& lamp, const Vec3f& to_lamp, float distance, float around_m) {
    if (!(distance > around_m)) return 1;
    const float cosine = std::clamp(-lamp.direction.dot(to_lamp) / distance, -1.0f, 1.0f);
    // The cosine of the difference of two angles: to the middle of the ball, and of half its apparent diameter.
    const float sine_of_half = around_m / distance, cosine_of_half = std::sqrt(1 - sine_of_half * sine_of_half);
    if (cosine >= cosine_of_half) return 1;
    return cosine * cosine_of_half + std::sqrt(1 - cosine * cosine) * sine_of_half;
}

}  // namespace

float lamp_strength(const Lamp& lamp, const Vec3f& place, float around_m, const Vec3f* normal) {
    const float all = lamp.intensity.x + lamp.intensity.y + lamp.intensity.z;
    if (lamp.kind == LampKind::directional)
        return normal ? all * std::clamp(lamp.sin_radius - lamp.direction.dot(*normal), 0.0f, 1.0f) : all;
    const Vec3f to_lamp = lamp.position - place;
    const float distance = to_lamp.length(), reach = around_m + lamp.radius;
    const float nearest = std::max(distance, reach);  // from inside the ball any distance is possible
    if (!(nearest > 0)) return 0;
    const float cone = lamp.kind == LampKind::spot ? cone_share(lamp, best_cosine(lamp, to_lamp, distance, around_m)) : 1.0f;
    const float shape = cone * range_share(lamp, std::max(0.0f, distance - around_m));
    const float cosine = normal ? std::clamp((to_lamp.dot(*normal) + reach) / nearest, 0.0f, 1.0f) : 1.0f;
    return std::min(all * shape * cosine / (nearest * nearest), std::numeric_limits<float>::max());
}

std::vector<LampStrength> lamp_strengths(std::span<const Lamp> lamps, const Vec3f& place, float around_m, const Vec3f* normal) {
    std::vector<LampStrength> found;
    found.reserve(lamps.size());
    for (std::uint32_t k = 0; k < lamps.size(); ++k)
        if (const float strength = lamp_strength(lamps[k], place, around_m, normal); strength > 0) found.push_back({k, strength});
    return found;
}

LampTable::LampTable(std::span<const LampStrength> lamps) {
    double total = 0, sum = 0;
    for (const LampStrength& lamp : lamps) total += static_cast<double>(lamp.strength);
    const double scale = 1 / total;
    entries_.reserve(lamps.size());
    for (const LampStrength& lamp : lamps) {
        sum += static_cast<double>(lamp.strength);
        entries_.push_back({lamp.lamp, static_cast<float>(static_cast<double>(lamp.strength) * scale), static_cast<float>(sum * scale)});
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

RankedLamps rank_lamps(std::vector<LampStrength> lamps) {
    double total = 0;
    for (const LampStrength& lamp : lamps) total += static_cast<double>(lamp.strength);
    // Few of them are strong: a heap is cheaper than sorting all.
    const auto is_weaker = [](const LampStrength& a, const LampStrength& b) {
        return a.strength != b.strength ? a.strength < b.strength : a.lamp > b.lamp;
    };
    std::make_heap(lamps.begin(), lamps.end(), is_weaker);
    RankedLamps ranked;
    const auto take = [&] {
        std::pop_heap(lamps.begin(), lamps.end(), is_weaker);
        const LampStrength strongest = lamps.back();
        lamps.pop_back();
        ranked.strong.push_back(strongest.lamp);
        return static_cast<double>(strongest.strength);
    };
    for (double rest = total; !lamps.empty() && rest > weak_share * total;) rest -= take();
    while (!lamps.empty() && lamps.size() <= static_cast<std::size_t>(RankedLamps::weak_choices)) take();
    ranked.weak = LampTable(lamps);
    return ranked;
}

}  // namespace luxel
