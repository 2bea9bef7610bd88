/// One lamp out of many, chosen by what it could give to points around a place: for vertices of paths, where a shadow
/// ray to each would cost more than it tells.
#pragma once
#include <span>
#include <vector>

#include "baker/scene/scene.h"

namespace luxel {

class LampTable {
  public:
    /// For points within `around_m` of `place`. Every lamp that can light one of them has a chance. Keeps no reference.
    LampTable(std::span<const Lamp> lamps, const Vec3f& place, float around_m);

    struct Choice {
        std::uint32_t lamp = 0;
        float probability = 0;  ///< > 0
        float rest = 0;         ///< what the choice has left of `random`: again uniform in [0, 1)
    };
    [[nodiscard]] bool empty() const { return entries_.empty(); }
    /// For `random` in [0, 1). Not empty.
    [[nodiscard]] Choice choose(float random) const;

  private:
    struct Entry {
        std::uint32_t lamp;
        float probability, up_to;  ///< cumulative; the last is 1
    };
    std::vector<Entry> entries_;
};

}  // namespace luxel
