#include "baker/accuracy/sensitivity.h"

#include <algorithm>
#include <cmath>

#include "baker/core/sobol.h"

namespace luxel {
namespace {

/// The choice of rays is in powers of two, and eight patterns say it only to a third.
constexpr double solve_tolerance = 0.03;

Patterns random_signs(const LightState& light) {
    Patterns y(light.ids.size());
    for (std::size_t i = 0; i < y.size(); ++i) {
        const std::uint64_t signs = mix(light.ids[i], 1);
        const auto root = static_cast<float>(std::sqrt(light.area_m2[i]));
        for (std::size_t v = 0; v < pattern_count; ++v) y[i][v] = (signs >> v) & 1 ? root : -root;
    }
    return y;
}

}  // namespace

Sensitivity::Sensitivity(BlockSource& source, const LightState& light) : light_(light) {
    check(light);
    const Patterns y = random_signs(light);
    for (std::size_t c = 0; c < 3; ++c) {
        if (is_dark(light, c)) continue;
        if (!channels_.empty() && same_channel(light, channels_.back().index, c)) {
            channels_.back().weight += 1;
            continue;
        }
        Channel channel{c, 1, solve_patterns(source, light, c, y, solve_tolerance), std::vector<double>(light.ids.size())};
        for (std::size_t i = 0; i < channel.x.size(); ++i)
            for (const float x : channel.x[i]) channel.square[i] += static_cast<double>(x) * static_cast<double>(x);
        channels_.push_back(std::move(channel));
    }
}

double Sensitivity::of_pair(PatchNumber i, PatchNumber j) const {
    double sum = 0;
    for (const Channel& channel : channels_) {
        const std::size_t c = channel.index;
        const double at_i = light_.radiosity[j][c] - light_.row_mean[i][c];
        const double at_j = light_.radiosity[i][c] - light_.row_mean[j][c];
        float both = 0;
        for (std::size_t v = 0; v < pattern_count; ++v) both += channel.x[i][v] * channel.x[j][v];
        sum += channel.weight * (at_i * at_i * channel.square[i] + 2 * at_i * at_j * static_cast<double>(both) +
                                 at_j * at_j * channel.square[j]);
    }
    return std::max(0.0, sum) / static_cast<double>(pattern_count);
}

double Sensitivity::of_open(PatchNumber i) const {
    double sum = 0;
    for (const Channel& channel : channels_) {
        const double mean = light_.row_mean[i][channel.index];
        sum += channel.weight * mean * mean * channel.square[i];
    }
    return sum / static_cast<double>(pattern_count);
}

}  // namespace luxel
