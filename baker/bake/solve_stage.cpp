#include "baker/bake/solve_stage.h"

#include "baker/bake/endless_light.h"
#include "baker/bake/stage_files.h"
#include "baker/light/patch_lamps.h"
#include "baker/solver/energy_audit.h"
#include "baker/solver/solve.h"
#include "baker/store/block_cache.h"

namespace luxel {
namespace {

/// Light that the equation starts from: self-emission, and what the patch reflects of the lamps' direct light.
std::vector<Channels> first_light(const PatchSet& patches, std::span<const Rgb> lamp_irradiance) {
    std::vector<Channels> values(patches.count());
    for (std::size_t p = 0; p < values.size(); ++p)
        for (int c = 0; c < 3; ++c)
            values[p][static_cast<std::size_t>(c)] =
                static_cast<double>(patches.patches[p].emission[c]) +
                static_cast<double>(patches.patches[p].reflectance[c]) * static_cast<double>(lamp_irradiance[p][c]);
    return values;
}

void audit(const BakedGeometry& g, const BakedSources& sources, const BakedMatrix& matrix, const BakedSolution& solution,
           BakeReport& report) {
    const EnergyAudit energy =
        audit_energy(matrix.area_m2, matrix.closure.row_open_m2, {solution.reflectance, sources.emission}, solution.result);
    report.emitted_lm = energy.emitted_lm;
    report.absorbed_lm = energy.absorbed_lm;
    report.lost_lm = energy.lost_lm;
    // The equation knows only the reflected part of the lamps' light; the rest was absorbed on arrival.
    for (std::size_t p = 0; p < matrix.area_m2.size(); ++p)
        for (std::size_t c = 0; c < 3; ++c) {
            const double arrived = matrix.area_m2[p] * static_cast<double>(sources.lamp_irradiance[p][static_cast<int>(c)]);
            const double kept = arrived * (1 - static_cast<double>(g.patches.patches[p].reflectance[static_cast<int>(c)]));
            report.emitted_lm[c] += kept;
            report.absorbed_lm[c] += kept;
        }
}

}  // namespace

BakedSources light_patches(const BakeOptions& options, const BakedGeometry& g, StageClock& clock, BakeReport& report) {
    BakedSources sources;
    clock.stage("lamps", [&] {
        sources.lamp_irradiance = patch_lamp_irradiance(g.scene, g.atlas, g.patches, *g.tracer, options.lamp_points);
        sources.emission = first_light(g.patches, sources.lamp_irradiance);
        return false;
    });
    if (g.scene.lamps.empty()) report.skipped.push_back({"lamps", "the scene has no punctual lights"});
    return sources;
}

Key solution_key(const BakeOptions& options, const BakedGeometry& g, const Key& matrix_key, double tolerance) {
    return KeyBuilder("solution 2")
        .text(solver_names()[static_cast<std::size_t>(options.solver)])
        .key(matrix_key)
        .key(g.scene.light_key)
        .number(tolerance)
        .integer(options.lamp_points)
        .finish();
}

BakedSolution solve_patches(const BakeOptions& options, const BakedGeometry& g, const BakedSources& sources,
                            const BakedMatrix& matrix, double tolerance, const BakeFolder& folder, StageClock& clock,
                            BakeReport& report) {
    BakedSolution solution;
    solution.key = solution_key(options, g, matrix.key, tolerance);
    solution.reflectance = solvable_reflectances(g.patches, matrix.strips->tallies());
    clock.stage("solve", [&] {
        const auto path = folder.solution(solution.key);
        if (auto result = load_solution(path, solution.key, g.patches.count())) {
            solution.result = std::move(*result);
            return true;
        }
        ClosedMatrix strips(*matrix.strips, matrix.area_m2, matrix.closure);
        BlockCache cache(strips, matrix.cache_bytes);
        SolveOptions solve;
        solve.tolerance = tolerance;
        const ProgressFunction progress = clock.progress("pages read");
        if (progress)
            solve.step = [&](const SolveView& view) {
                progress(view.bytes_read() / 4096, 0);
                return true;
            };
        solution.result = luxel::solve(options.solver, cache, {solution.reflectance, sources.emission}, solve);
        save_solution(path, solution.key, solution.result);
        return false;
    });
    const SolveResult& result = solution.result;
    report.solver = result.solver;
    report.reads = result.reads;
    report.error_bound = result.error_bound;
    report.converged = result.converged;
    report.history.clear();
    for (const SolveStep& step : result.history) report.history.push_back({step.bytes_read, step.error_bound});
    audit(g, sources, matrix, solution, report);
    return solution;
}

}  // namespace luxel
