/// What was measured of one point of a sweep, and its form as JSON (docs/sweep.md).
///
/// Threads  pure.  Errors  Error{bad_input} naming the file and the member that is missing or of another kind.
#pragma once
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "baker/sweep/error_meter.h"
#include "baker/sweep/grid.h"
#include "baker/sweep/stage_costs.h"

namespace luxel {

struct PointResult {
    GridPoint point;
    std::string bake_line;  ///< the command, as a shell takes it
    bool failed = false;
    std::string message;    ///< why

    double seconds = 0;                  ///< from nothing; median of the repeats
    std::vector<double> repeat_seconds;  ///< each
    double processor_seconds = 0;        ///< of all threads, from nothing; median of the repeats
    std::vector<StageCost> stages;       ///< by name, those of one name together; medians
    std::uint64_t peak_bytes = 0;        ///< highest of the repeats
    std::uint64_t disk_bytes = 0;        ///< of the bake folder
    std::uint64_t model_bytes = 0;       ///< of the lightmapped scene
    RunFigures run;

    ErrorFigures error;
    Bytes error_map_png;
};

nlohmann::ordered_json point_json(const PointResult& result);
/// `error_map_png` is part of it.
std::string point_file(const PointResult& result);
PointResult parse_point_file(ByteView bytes, const std::string& where);

/// Costs of the same stages in several runs: sums by name, then the median of each.
std::vector<StageCost> median_stages(const std::vector<std::vector<StageCost>>& runs);
/// The middle one, or the mean of the two. At least one value.
double median_of(std::vector<double> values);

}  // namespace luxel
