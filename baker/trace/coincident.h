/// Triangles with exactly the same three corners (in any order): the tracer must choose one of them by rule.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "baker/scene/scene.h"

namespace luxel {

class CoincidentTriangles {
  public:
    explicit CoincidentTriangles(const Scene& scene);
    [[nodiscard]] bool empty() const { return group_of_.empty(); }
    /// Members of the triangle's group in ascending order; empty when it coincides with no other.
    [[nodiscard]] std::span<const std::uint32_t> group(std::uint32_t triangle) const;

  private:
    std::vector<std::uint32_t> group_of_;     ///< per triangle: index of its group or none; empty when there are no groups
    std::vector<std::uint32_t> group_begin_;  ///< groups + 1
    std::vector<std::uint32_t> members_;
};

/// Barycentrics (b1, b2) on triangle `from` of the scene, expressed on `to`, which has the same corners.
Vec2f transfer_barycentrics(const Scene& scene, std::uint32_t from, std::uint32_t to, Vec2f b);

}  // namespace luxel
