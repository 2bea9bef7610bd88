/// Which points of a sweep are worth choosing.
///
/// Threads  pure.
#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "baker/sweep/point_result.h"

namespace luxel {

struct CostAndError {
    double cost = 0, error = 0;
};

/// The Pareto front: indices of points that no other beats, that is, none has less of one and not more of the other. By rising cost; of
/// points that are equal in both the first.
std::vector<std::size_t> pareto_front(std::span<const CostAndError> points);

/// What a user wants; what is not set is not asked for.
struct SweepTargets {
    std::optional<double> error;    ///< relative RMSE at most
    std::optional<double> seconds;  ///< at most
    std::optional<std::uint64_t> disk_bytes;
    [[nodiscard]] bool any() const { return error || seconds || disk_bytes; }
};

/// The point with the least seconds of those that meet all targets and ended well; without a target for the error, the one with the
/// least error instead, since otherwise the worst would win. Null: none.
const PointResult* choose_point(const std::vector<PointResult>& points, const SweepTargets& targets);

}  // namespace luxel
