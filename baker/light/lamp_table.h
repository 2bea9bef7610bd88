/// Which of many lamps are worth a shadow ray, by what each could give to the points around a place: the strongest are tested one by
/// one, of the rest a few are chosen by chance. Threads: const and reentrant. Errors: none.
#pragma once
#include <span>
#include <vector>

#include "baker/scene/scene.h"

namespace luxel {

struct LampStrength {
    std::uint32_t lamp = 0;  ///< index into Scene::lamps
    float strength = 0;      ///< > 0; about what it gives without shadows, lux
};

/// About what the lamp gives to points within `around_m` of `place`, lux, without shadows, all channels together; 0 only where none of them can get light from it.
/// `normal`: as below.
float lamp_strength(const Lamp& lamp, const Vec3f& place, float around_m, const Vec3f* normal);

/// Every lamp that can light a point within `around_m` of `place`, in the scene's order. `normal`: unit, what the cosine is taken
/// against at all of these points; null: it differs, and no lamp is behind all of them.
std::vector<LampStrength> lamp_strengths(std::span<const Lamp> lamps, const Vec3f& place, float around_m, const Vec3f* normal);

/// One lamp out of many, in proportion to its strength.
class LampTable {
  public:
    LampTable() = default;
    /// Keeps no reference.
    explicit LampTable(std::span<const LampStrength> lamps);

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

struct RankedLamps {
    std::vector<std::uint32_t> strong;  ///< the strongest first: all but a tenth of the light
    LampTable weak;                     ///< the rest; empty where they are few
    /// Choices of weak lamps at a point: fewer than these are strong ones.
    static constexpr int weak_choices = 2;
};

/// A pure function; of equally strong ones the first of the scene is the stronger.
RankedLamps rank_lamps(std::vector<LampStrength> lamps);

}  // namespace luxel
