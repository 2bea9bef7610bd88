/// Which one of all lamps to ask for light at a point: chosen in proportion to about what each gives there, were there no shadows. Lamps are nodes of a tree of
/// balls; a way down the tree takes the side that can give more more often, and the few lamps at its end are weighed exactly. So a lamp close to the point is seldom
/// missed: chosen one time in a hundred it would count a hundredfold, a bright dot on the lightmap.
///
/// Errors: none. Threads: const and reentrant; a pure function of its inputs.
/// Source: Conty Estevez and Kulla, Importance Sampling of Many Lights with Adaptive Tree Splitting, HPG 2018 (without splitting).
#pragma once
#include <optional>
#include <span>
#include <vector>

#include "baker/light/lamp_table.h"

namespace luxel {

struct LitPoint {
    Vec3f position;  ///< m, relative to Scene::origin
    Vec3f normal;    ///< unit, geometric, of the side that is lit
};

class LampTree {
  public:
    /// `lamps` must outlive it.
    explicit LampTree(std::span<const Lamp> lamps);

    [[nodiscard]] bool empty() const { return lamps_.empty(); }
    /// For `random` in [0, 1); nothing where this way leads to no light. Over all `random`, each lamp that gives light comes with its probability.
    /// `spot_m`: near a lamp its light is weighed as spread_in_spot() spreads it.
    [[nodiscard]] std::optional<LampTable::Choice> choose(const LitPoint& at, float random, float spot_m) const;

    /// Lamps that are weighed exactly at the end of a way.
    static constexpr std::size_t leaf_lamps = 8;

  private:
    struct Node {
        Vec3f center;
        float radius_m;          ///< around all lamps below, with their own
        double power;            ///< cd, sum of their intensities, all channels
        float reach_m;           ///< of the one that reaches farthest; infinite without a range
        std::uint32_t first, end;  ///< run in order_
        std::uint32_t right;     ///< index of the second child, the first is the next node; 0: a leaf
    };
    std::uint32_t add_node(std::uint32_t first, std::uint32_t end);
    /// About what it gives, lux. In double: the brightest lamps at the smallest distances are beyond single precision.
    [[nodiscard]] static double importance(const Node& node, const LitPoint& at);
    /// One of a run of order_, weighed exactly.
    [[nodiscard]] std::optional<LampTable::Choice> choose_of(std::uint32_t first, std::uint32_t end, const LitPoint& at, double random, float spot_m) const;
    [[nodiscard]] double strength(std::uint32_t lamp, const LitPoint& at, float spot_m) const;

    std::span<const Lamp> lamps_;
    std::vector<std::uint32_t> order_;      ///< lamps of the tree, then directional ones
    std::uint32_t directional_ = 0;         ///< where those begin
    std::vector<Node> nodes_;
};

}  // namespace luxel
