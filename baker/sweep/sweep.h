/// Bakes a scene over a grid of settings and measures each bake: seconds, memory, disk, and how far its light is from a reference.
///
/// Each point is a `luxel bake` of its own, one after the other. They share bake folders, so that what their settings have in common is done
/// once; what a point would have taken from nothing follows from stage_costs.h. Everything lies in one folder:
///
///     points/<key>.json            what was measured; found again by a sweep with the same scene, program, options and reference
///     reference/<key>/a.*, b.*     the bakes of the reference, found again the same way
///     work/<store>-<repeat>/       the bake folders, removed when all points are measured (unless they are to be kept)
///     runs/                        the bake that runs now, its report and its messages
///
/// A bake folder whose last bake did not end well has stages that are half done, whose time nobody knows: it is removed and begun anew.
///
/// Threads  one at a time; each bake uses as many as its options say.
/// Errors   Error{cannot_write}; Error{bad_input} where the reference cannot be made or does not fit. A point whose bake fails is a result.
#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "baker/core/stop.h"
#include "baker/sweep/point_result.h"
#include "baker/sweep/sweep_reference.h"
#include "formats/base/hash.h"

namespace luxel {

struct SweepOptions {
    std::filesystem::path program;  ///< luxel
    std::filesystem::path scene, folder;
    std::vector<BakeSetting> common;           ///< for all points that do not say otherwise
    std::vector<BakeSetting> reference_common;  ///< those of them that the reference keeps
    std::vector<GridPoint> points;
    std::vector<std::filesystem::path> reference_pages;  ///< empty: the reference is baked
    std::uint32_t repeats = 1;
    Key inputs;  ///< of scene, files that options name, and program
    bool keep_work = false;
    const StopRequest* stop = nullptr;
    std::function<void(const std::string&)> progress;  ///< a line now and then
};

struct SweepResult {
    std::vector<PointResult> points;  ///< in the order of the grid, those that were measured or failed
    std::string reference;            ///< what it is, for people
    std::size_t found = 0;            ///< points that were measured before
    bool interrupted = false;
};

SweepResult run_sweep(const SweepOptions& options);

/// "luxel bake hall.glb -o out/hall.glb --rays 64"
std::string bake_line(const SweepOptions& options, const GridPoint& point);

}  // namespace luxel
