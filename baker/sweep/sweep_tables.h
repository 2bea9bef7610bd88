/// The results of a sweep for programs: CSV and JSON (docs/sweep.md).
///
/// Threads  pure. The same results give the same bytes.
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "baker/sweep/front.h"
#include "baker/sweep/sweep.h"

namespace luxel {

/// What the tables and the page say beside the points.
struct SweepSummary {
    std::string software;  ///< name and version
    std::string scene;     ///< as it was given
    std::vector<std::pair<std::string, std::string>> common;  ///< options for all points and their values
    SweepTargets targets;
    const PointResult* chosen = nullptr;  ///< the cheapest that meets the targets; one of the result's points
};

/// Of points that ended well: which are on the front of error against seconds, memory, disk. As many flags as points.
struct Fronts {
    std::vector<bool> seconds, memory, disk;
};
Fronts find_fronts(const std::vector<PointResult>& points);

/// One line per point, RFC 4180; empty fields where a bake failed or does not know.
std::string sweep_csv(const SweepResult& result);
std::string sweep_json(const SweepResult& result, const SweepSummary& summary);

}  // namespace luxel
