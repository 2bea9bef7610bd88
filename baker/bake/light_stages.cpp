#include "baker/bake/light_stages.h"

#include <algorithm>

#include "baker/bake/stage_files.h"
#include "baker/light/gather.h"
#include "baker/light/patch_irradiance.h"
#include "baker/light/patch_lamps.h"
#include "baker/solver/energy_audit.h"
#include "baker/solver/shoot.h"
#include "baker/store/block_cache.h"

namespace luxel {
namespace {

/// Reflectance per patch. Exactly 1 is common (glTF's default colour) and would let light in a crack bounce for ever: that
/// no way out exists is known only as well as the patch's rays can tell, so it is taken as 1 - 1 / (2 N).
std::vector<Rgb> reflectances(const PatchSet& patches, const StripTallies& tallies) {
    std::vector<Rgb> values;
    for (std::size_t p = 0; p < patches.count(); ++p) {
        const float most = 1 - 0.5f / static_cast<float>(std::max(tallies.rays[p], 1u));
        Rgb value = patches.patches[p].reflectance;
        for (int c = 0; c < 3; ++c)
            if (value[c] >= 1) value[c] = most;
        values.push_back(value);
    }
    return values;
}

/// Light that the equation starts from: self-emission, and what the patch reflects of the lamps' direct light.
std::vector<Channels> sources(const PatchSet& patches, std::span<const Rgb> lamp_irradiance) {
    std::vector<Channels> values(patches.count());
    for (std::size_t p = 0; p < values.size(); ++p)
        for (int c = 0; c < 3; ++c)
            values[p][static_cast<std::size_t>(c)] =
                static_cast<double>(patches.patches[p].emission[c]) +
                static_cast<double>(patches.patches[p].reflectance[c]) * static_cast<double>(lamp_irradiance[p][c]);
    return values;
}

Rgb to_rgb(const Channels& c) {
    return {static_cast<float>(c[0]), static_cast<float>(c[1]), static_cast<float>(c[2])};
}

void audit(const BakedGeometry& g, const BakedMatrix& matrix, const BakedSolution& solution, const SolveInput& input,
           BakeReport& report) {
    const EnergyAudit energy = audit_energy(matrix.area_m2, matrix.closure.row_open_m2, input, solution.result);
    report.emitted_lm = energy.emitted_lm;
    report.absorbed_lm = energy.absorbed_lm;
    report.lost_lm = energy.lost_lm;
    // The equation knows only the reflected part of the lamps' light; the rest was absorbed on arrival.
    for (std::size_t p = 0; p < matrix.area_m2.size(); ++p)
        for (std::size_t c = 0; c < 3; ++c) {
            const double arrived = matrix.area_m2[p] * static_cast<double>(solution.lamp_irradiance[p][static_cast<int>(c)]);
            const double kept = arrived * (1 - static_cast<double>(g.patches.patches[p].reflectance[static_cast<int>(c)]));
            report.emitted_lm[c] += kept;
            report.absorbed_lm[c] += kept;
        }
}

}  // namespace

BakedSolution solve_patches(const BakeOptions& options, const BakedGeometry& g, const BakedMatrix& matrix,
                            const BakeFolder& folder, const MemoryPlan& plan, StageClock& clock, BakeReport& report) {
    BakedSolution solution;
    clock.stage("lamps", [&] {
        solution.lamp_irradiance = patch_lamp_irradiance(g.scene, g.atlas, g.patches, *g.tracer, options.lamp_points);
        return false;
    });
    if (g.scene.lamps.empty()) report.skipped.push_back({"lamps", "the scene has no punctual lights"});
    solution.key = KeyBuilder("solution 1")
                       .key(matrix.key)
                       .key(g.scene.light_key)
                       .number(options.tolerance)
                       .integer(options.lamp_points)
                       .finish();
    const std::vector<Rgb> reflectance = reflectances(g.patches, matrix.strips->tallies());
    const std::vector<Channels> emission = sources(g.patches, solution.lamp_irradiance);
    clock.stage("solve", [&] {
        const auto path = folder.solution(solution.key);
        if (auto result = load_solution(path, solution.key, g.patches.count())) {
            solution.result = std::move(*result);
            return true;
        }
        ClosedStrips strips(*matrix.strips, matrix.area_m2, matrix.closure);
        BlockCache cache(strips, plan.cache_bytes);
        SolveOptions solve;
        solve.tolerance = options.tolerance;
        const ProgressFunction progress = clock.progress("pages read");
        if (progress)
            solve.progress = [&](std::uint64_t bytes, double) { progress(bytes / 4096, 0); };
        solution.result = solve_by_shooting(cache, {reflectance, emission}, solve);
        save_solution(path, solution.key, solution.result);
        return false;
    });
    const SolveResult& result = solution.result;
    report.solver = result.solver;
    report.reads = result.reads;
    report.error_bound = result.error_bound;
    report.converged = result.converged;
    for (const SolveStep& step : result.history) report.history.push_back({step.bytes_read, step.error_bound});
    if (!result.converged)
        report.warnings.push_back({"not-converged", "solve",
                                   "stopped at an error bound of " + std::to_string(result.error_bound) +
                                       " before the tolerance was met"});
    audit(g, matrix, solution, {reflectance, emission}, report);
    return solution;
}

BakedLight light_texels(const BakeOptions& options, const BakedGeometry& g, const BakedMatrix& matrix,
                        const BakedSolution& solution, const BakeFolder& folder, StageClock& clock, BakeReport& report) {
    BakedLight light;
    light.key = KeyBuilder("light 2")
                    .key(solution.key)
                    .integer(options.gather_rays)
                    .integer(options.lamp_points)
                    .integer(static_cast<std::int64_t>(options.seed))
                    .integer(static_cast<int>(options.interpolation))
                    .finish();
    light.folder = folder.lightmaps(light.key);
    std::vector<Rgb> radiosity;
    for (const Channels& b : solution.result.radiosity) radiosity.push_back(to_rgb(b));
    if (options.gather_rays == 0) report.skipped.push_back({"gather", "draft quality interpolates the patches"});
    clock.stage("light", [&] {
        ProgressCounter progress(g.texels.texel_count(), clock.progress("texels"));
        const EmitterSet emitters(g.scene, g.atlas, g.patches);
        std::vector<Rgb> irradiance;  // per patch, only for drafts
        bool reused = true;
        for (std::uint32_t page = 0; page < g.atlas.page_count; ++page) {
            const auto path = BakeFolder::lightmap_file(light.folder, page);
            if (load_lightmap(path, light.key, g.texels.pages[page].texels.size())) continue;
            reused = false;
            if (options.gather_rays) {
                const GatherInput input{g.scene, g.atlas, g.texels, g.patches, *g.tracer, emitters, radiosity};
                save_lightmap(path, light.key,
                              gather_page(input, page, {options.gather_rays, true, options.lamp_points, options.seed}, &progress));
            } else {
                if (irradiance.empty()) {
                    ClosedStrips strips(*matrix.strips, matrix.area_m2, matrix.closure);
                    irradiance = patch_irradiance(strips, solution.result.radiosity, solution.lamp_irradiance);
                }
                save_lightmap(path, light.key,
                              interpolate_page(g.atlas, g.texels, g.patches, irradiance, page, options.patch_texels,
                                               options.interpolation));
                progress.add(g.texels.pages[page].texels.size());
            }
        }
        return reused;
    });
    return light;
}

}  // namespace luxel
