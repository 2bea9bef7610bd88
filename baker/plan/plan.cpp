#include "baker/plan/plan.h"

#include "baker/bake/memory_demand.h"
#include "baker/bake/stopping.h"
#include "baker/core/parallel.h"
#include "baker/plan/decisions.h"
#include "baker/plan/lint.h"

namespace luxel {
namespace {

/// Large enough for everything: only the floor is asked for.
constexpr std::uint64_t any_budget = std::uint64_t{1} << 62;

void refuse_if_stopping(const BakeOptions& options) {
    if (is_stopping(options)) throw Error(ErrorCode::stopped_early, options.input.string(), "stopped before the plan was complete", "run it again, with more time");
}

}  // namespace

PlanReport plan_bake(const BakeOptions& options) {
    if (!std::filesystem::exists(options.input))
        throw Error(ErrorCode::bad_input, options.input.string(), "no such file", "check the path");
    const ThreadLimit threads(options.threads);
    // Without a bake folder of the user's, the atlas goes where temporary files go.
    const BakeFolder folder(options.work, options.output.empty() ? std::filesystem::temp_directory_path() / "luxel-plan.glb" : options.output);
    BakeReport report;
    StageClock clock(options, report);
    PlanReport plan;
    const auto geometry = prepare_geometry(options, folder, clock, report);
    refuse_if_stopping(options);
    report.geometry_bytes = plan.geometry_bytes = geometry->resident_bytes();
    plan.floor_bytes = plan_memory(any_budget, memory_demand(options, *geometry, report, threads.threads())).floor_bytes;
    plan.decisions = decide(options, *geometry);
    clock.stage("lint", [&] {
        plan.findings = lint_scene(*geometry);
        const std::vector<SceneFinding> of_light = lint_light(*geometry);
        plan.findings.insert(plan.findings.end(), of_light.begin(), of_light.end());
        return false;
    });
    refuse_if_stopping(options);
    std::erase_if(report.warnings, [](const Warning& warning) { return warning.code == "dark-fronts"; });  // a finding already
    plan.triangles = report.triangles, plan.charts = report.charts, plan.pages = report.pages, plan.texels = report.texels;
    plan.patches = report.patches, plan.chunks = report.chunks, plan.texels_per_metre = report.texels_per_metre;
    plan.stages = std::move(report.stages);
    plan.warnings = std::move(report.warnings);
    return plan;
}

}  // namespace luxel
