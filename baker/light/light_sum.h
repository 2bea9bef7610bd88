/// Light added up in double: thousands of small contributions to one texel. Threads: none.
#pragma once
#include <array>

#include "baker/core/vec.h"

namespace luxel {

/// Channels in whatever unit is added, lux as a rule.
class LightSum {
  public:
    void add(const Rgb& light, float weight) { add(light, Rgb(weight, weight, weight)); }
    void add(const Rgb& light, const Rgb& weight) {
        for (int c = 0; c < 3; ++c)
            sums_[static_cast<std::size_t>(c)] += static_cast<double>(light[c]) * static_cast<double>(weight[c]);
    }
    [[nodiscard]] Rgb rgb() const {
        return {static_cast<float>(sums_[0]), static_cast<float>(sums_[1]), static_cast<float>(sums_[2])};
    }

  private:
    std::array<double, 3> sums_{};
};

}  // namespace luxel
