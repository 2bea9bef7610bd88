#include "baker/chunks/space_halving.h"

#include <algorithm>
#include <cmath>

namespace luxel {
namespace {

struct Box {
    Vec3d low, high;
};

class Halver {
  public:
    Halver(std::span<const Vec3d> places, std::span<const std::uint32_t> sizes, std::uint32_t limit)
        : places_(places), sizes_(sizes), limit_(limit) {}

    void cut(std::vector<std::uint32_t> members, const Box& box, int depth) {
        if (members.empty()) return;
        std::uint64_t size = 0;
        for (const std::uint32_t m : members) size += sizes_[m];
        constexpr int max_depth = 96;
        if (size <= limit_ || depth == max_depth) return fill(members);
        // Longest edge first; ties go to x, then z: floors are wider than they are high.
        const Vec3d edges = box.high - box.low;
        const int axis = edges.x >= edges.y && edges.x >= edges.z ? 0 : edges.z >= edges.y ? 2 : 1;
        const double middle = 0.5 * (box.low[axis] + box.high[axis]);
        std::vector<std::uint32_t> low, high;
        for (const std::uint32_t m : members) (places_[m][axis] < middle ? low : high).push_back(m);
        members = {};
        Box half = box;
        half.high[axis] = middle;
        cut(std::move(low), half, depth + 1);
        half = box;
        half.low[axis] = middle;
        cut(std::move(high), half, depth + 1);
    }

    std::vector<std::vector<std::uint32_t>> groups;

  private:
    void fill(const std::vector<std::uint32_t>& members) {
        std::uint64_t size = limit_;
        for (const std::uint32_t m : members) {
            if (size + sizes_[m] > limit_) groups.emplace_back(), size = 0;
            groups.back().push_back(m);
            size += sizes_[m];
        }
    }

    std::span<const Vec3d> places_;
    std::span<const std::uint32_t> sizes_;
    std::uint64_t limit_;
};

}  // namespace

std::vector<std::vector<std::uint32_t>> halve_space(std::span<const Vec3d> places, std::span<const std::uint32_t> sizes,
                                                    std::vector<std::uint32_t> members, std::uint32_t limit) {
    double reach = 0;
    for (const std::uint32_t m : members)
        for (int k = 0; k < 3; ++k) reach = std::max(reach, std::fabs(places[m][k]));
    // The first box is a power of two, so that its halvings stay where they are when there is a little more.
    const double half = std::exp2(std::ceil(std::log2(std::max(reach, 1e-30)) + 1e-9));
    Halver halver(places, sizes, limit);
    halver.cut(std::move(members), {{-half, -half, -half}, {half, half, half}}, 0);
    return std::move(halver.groups);
}

}  // namespace luxel
