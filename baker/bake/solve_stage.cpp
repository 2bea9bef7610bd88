#include "baker/bake/solve_stage.h"

#include <algorithm>
#include <cstdio>

#include "baker/bake/endless_light.h"
#include "baker/bake/sky_stage.h"
#include "baker/bake/solve_watch.h"
#include "baker/bake/stage_files.h"
#include "baker/bake/stopping.h"
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

/// Which way the solve takes: the same operations in the same order, with or without reads of the disk after the first of each block.
void tell_path(const BakedMatrix& matrix, std::uint64_t cache_bytes, BakeReport& report) {
    const ChunkLayout& layout = matrix.strips->layout();
    std::uint64_t decoded = 0;
    for (const BlockInfo& block : matrix.strips->blocks())
        decoded += BlockCache::resident_bytes(block, layout);
    report.solve_path = decoded <= cache_bytes ? "in memory" : "out of core";
    char text[128];
    std::snprintf(text, sizeof text, "all decoded blocks take %.1f MB, the cache may hold %.1f MB", static_cast<double>(decoded) / 0x1p20,
                  static_cast<double>(cache_bytes) / 0x1p20);
    report.solve_path_why = text;
}

/// Solves from the beginning, or from a checkpoint that fits.
SolveResult solve_watched(SolverKind kind, BlockSource& source, const SolveInput& input, double tolerance,
                          std::optional<SolveState> checkpoint, SolveWatch& watch, BakeReport& report) {
    SolveOptions options;
    options.tolerance = tolerance;
    // A row that is read again for the next of its patches counts as read again, whatever is cached.
    if (kind == SolverKind::shoot_patch) options.max_reads *= ChunkLayout::max_chunk_patches;
    options.step = [&](const SolveView& view) { return watch.step(view); };
    if (checkpoint) {
        options.resume = &*checkpoint;
        try {
            SolveResult result = luxel::solve(kind, source, input, options);
            report.checkpoint_resumed = true;
            return result;
        } catch (const Error& error) {
            // Of a solver that kept other vectors: what it had done is done again.
            if (error.code != ErrorCode::internal || watch.steps() > 0) throw;
        }
        options.resume = nullptr;
        checkpoint.reset();
    }
    return luxel::solve(kind, source, input, options);
}

}  // namespace

BakedSources light_patches(const BakeOptions& options, const BakedGeometry& g, const BakeFolder& folder, StageClock& clock,
                           BakeReport& report) {
    BakedSources sources;
    clock.stage("lamps", [&] {
        sources.lamp_irradiance = patch_lamp_irradiance(g.scene, g.atlas, g.patches, *g.tracer, options.lamp_points, options.edge_lamp_points());
        return false;
    });
    sources.sky = add_sky_light(options, g, folder, sources.lamp_irradiance, clock, report);
    sources.emission = first_light(g.patches, sources.lamp_irradiance);
    return sources;
}

Key solution_key(const BakeOptions& options, const BakedGeometry& g, const Key& matrix_key, double tolerance) {
    KeyBuilder key("solution 6");
    key.text(solver_names()[static_cast<std::size_t>(options.solver)])
        .key(matrix_key)
        .key(g.scene.light_key)
        .number(tolerance)
        .integer(options.lamp_points);
    if (!g.scene.sky.empty()) key.key(sky_view_key(options, g));
    return key.finish();
}

BakedSolution solve_patches(const BakeOptions& options, const BakedGeometry& g, const BakedSources& sources,
                            const BakedMatrix& matrix, double tolerance, const BakeFolder& folder, Preview* preview,
                            StageClock& clock, BakeReport& report) {
    BakedSolution solution;
    solution.key = solution_key(options, g, matrix.key, tolerance);
    solution.reflectance = solvable_reflectances(g.patches, matrix.strips->tallies());
    const std::uint64_t cache_bytes = options.forced.has(Part::disk) ? 0 : matrix.cache_bytes;
    clock.stage("solve", [&] {
        const auto path = folder.solution(solution.key);
        clock.keeps(path);
        if (auto result = load_solution(path, solution.key, g.patches.count())) {
            solution.result = std::move(*result);
            folder.discard_checkpoint(solution.key);
            return true;
        }
        ClosedMatrix strips(*matrix.strips, matrix.area_m2, matrix.closure);
        // Rows that are traced again use all threads already.
        BlockCache cache(strips, cache_bytes, options.store == StoreKind::all && options.threads != 1);
        const auto checkpoint = folder.checkpoint(solution.key);
        SolveWatch watch(options, checkpoint, solution.key, clock.progress("pages read"), preview);
        solution.result = solve_watched(options.solver, cache, {solution.reflectance, sources.emission}, tolerance,
                                        load_checkpoint(checkpoint, solution.key), watch, report);
        watch.finish();
        solution.is_whole = solution.result.converged || !watch.has_stopped();
        if (solution.is_whole) {
            save_solution(path, solution.key, solution.result);
            folder.discard_checkpoint(solution.key);
        } else {
            note_stop(report, "solve", "the solve ended after " + std::to_string(solution.result.history.size()) + " steps");
        }
        return false;
    });
    tell_path(matrix, cache_bytes, report);
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
