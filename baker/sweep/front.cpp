#include "baker/sweep/front.h"

#include <algorithm>
#include <numeric>

namespace luxel {

std::vector<std::size_t> pareto_front(std::span<const CostAndError> points) {
    std::vector<std::size_t> order(points.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return points[a].cost != points[b].cost ? points[a].cost < points[b].cost : points[a].error < points[b].error;
    });
    std::vector<std::size_t> front;
    for (const std::size_t k : order)
        if (front.empty() || points[k].error < points[front.back()].error) front.push_back(k);
    return front;
}

const PointResult* choose_point(const std::vector<PointResult>& points, const SweepTargets& targets) {
    const PointResult* best = nullptr;
    for (const PointResult& p : points) {
        const bool meets = !p.failed && p.run.is_whole && (!targets.error || p.error.relative_rmse <= *targets.error) &&
                           (!targets.seconds || p.seconds <= *targets.seconds) && (!targets.disk_bytes || p.disk_bytes <= *targets.disk_bytes);
        if (!meets) continue;
        const auto worth = [&](const PointResult& q) { return targets.error ? q.seconds : q.error.relative_rmse; };
        if (!best || worth(p) < worth(*best)) best = &p;
    }
    return best;
}

}  // namespace luxel
