#include "baker/plan/plan.h"

#include "baker/bake/memory_demand.h"
#include "baker/bake/stopping.h"
#include "baker/core/parallel.h"
#include "baker/plan/foreseen_decisions.h"
#include "baker/plan/lint.h"
#include "baker/plan/sight_sample.h"

namespace luxel {
namespace {

void refuse_if_stopping(const BakeOptions& options) {
    if (is_stopping(options)) throw Error(ErrorCode::stopped_early, options.input.string(), "stopped before the plan was complete", "run it again, with more time");
}

void foresee(const PlanWishes& wishes, const BakedGeometry& geometry, double geometry_seconds, const MemoryDemand& demand, const BakeOptions& options, PlanReport& plan) {
    for (const NamedOptions& preset : wishes.presets) {
        refuse_if_stopping(options);
        plan.forecasts.push_back(forecast(preset, geometry, geometry_seconds));
    }
    plan.advice = advise_memory(options.memory_bytes, demand);
    const auto add = [&](const std::vector<Advice>& advice) { plan.advice.insert(plan.advice.end(), advice.begin(), advice.end()); };
    if (wishes.seconds > 0) {
        plan.choice = best_within(wishes.seconds, wishes.ladder, geometry, geometry_seconds);
        add(advise_time(wishes.seconds, *plan.choice, plan.texels_per_metre));
    }
    if (wishes.disk_bytes > 0) add(advise_disk(wishes.disk_bytes, plan.choice ? *plan.choice : forecast({"", options}, geometry, geometry_seconds)));
}

}  // namespace

PlanReport plan_bake(const BakeOptions& options, const PlanWishes& wishes) {
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
    const MemoryDemand demand = memory_demand(options, *geometry, report, threads.threads());
    plan.floor_bytes = memory_floor(demand);
    plan.texels_per_metre = report.texels_per_metre;
    double geometry_seconds = 0;
    for (const StageReport& stage : report.stages) geometry_seconds += stage.seconds;
    clock.stage("forecast", [&] {
        foresee(wishes, *geometry, geometry_seconds, demand, options, plan);
        return false;
    });
    clock.stage("lint", [&] {
        plan.findings = lint_scene(*geometry);
        const std::vector<SceneFinding> of_light = lint_light(*geometry);
        plan.findings.insert(plan.findings.end(), of_light.begin(), of_light.end());
        plan.decisions = decide(options, *geometry);
        const std::uint64_t cache_bytes = plan_memory(std::max(options.memory_bytes, plan.floor_bytes), demand).cache_bytes;
        foresee_decisions(options, *geometry, plan.findings, static_cast<std::uint64_t>(sample_sight(options, *geometry).pairs), cache_bytes, plan.decisions);
        return false;
    });
    refuse_if_stopping(options);
    std::erase_if(report.warnings, [](const Warning& warning) { return warning.code == "dark-fronts"; });  // a finding already
    plan.triangles = report.triangles, plan.charts = report.charts, plan.pages = report.pages, plan.texels = report.texels;
    plan.patches = report.patches, plan.chunks = report.chunks;
    plan.stages = std::move(report.stages);
    plan.warnings = std::move(report.warnings);
    return plan;
}

}  // namespace luxel
