#include "baker/bake/bake.h"

#include "baker/bake/decisions.h"
#include "baker/bake/geometry_stages.h"
#include "baker/bake/light_stages.h"
#include "baker/bake/memory_demand.h"
#include "baker/bake/solve_rounds.h"
#include "baker/bake/stopping.h"
#include "baker/bake/unlit_stage.h"
#include "baker/bake/verify.h"
#include "baker/bake/write_stage.h"
#include "baker/core/parallel.h"
#include "formats/base/file.h"

namespace luxel {
namespace {

/// What can be known before any work is done.
void check_paths(const BakeOptions& options) {
    std::error_code ignored;
    if (std::filesystem::is_directory(options.output, ignored))
        throw Error(ErrorCode::cannot_write, options.output.string(), "expected a file name, found a folder",
                    "name a file inside it, for example " + (options.output / "baked.glb").string());
    const auto extension = options.output.extension();
    if (extension != ".glb" && extension != ".gltf")
        throw Error(ErrorCode::usage, options.output.string(), "expected a name ending in .glb or .gltf",
                    "the ending decides the form of the result");
    if (std::filesystem::exists(options.output, ignored) &&
        std::filesystem::equivalent(options.input, options.output, ignored))
        throw Error(ErrorCode::usage, options.output.string(), "the output would replace the input", "choose another name");
    if (options.unlit && std::filesystem::exists(unlit_path(options), ignored) && std::filesystem::equivalent(options.input, unlit_path(options), ignored))
        throw Error(ErrorCode::usage, unlit_path(options).string(), "the unlit model would replace the input", "choose another output name");
    if (!std::filesystem::exists(options.input, ignored))
        throw Error(ErrorCode::bad_input, options.input.string(), "no such file", "check the path");
    if (options.output.has_parent_path()) make_folder(options.output.parent_path());
}

/// Layers that nothing in this bake would fill.
void check_layers(const BakeOptions& options) {
    if (parts_light(options)) return;
    std::vector<Layer> others;
    for (const LayerInfo& info : all_layers)
        if (!info.is_of_light) others.push_back(info.layer);
    for (const Layer layer : options.layers)
        if (layer_info(layer).is_of_light)
            throw Error(ErrorCode::usage, "--aov", std::string("\"") + layer_info(layer).name + "\" needs the parts of each texel's light, which are not known with these options",
                        "leave it out; these can be written: " + layer_names(others));
}

void verify(const BakeFolder& folder, const Key& strip_key, const MemoryPlan& plan, StageClock& clock, BakeReport& report) {
    clock.stage("verify", [&] {
        VerifyOptions options;
        options.memory_bytes = plan.pooling_bytes;
        const ProgressFunction progress = clock.progress("bytes");
        // Files first, which is most of it; the other parts count in other units.
        options.progress = [&](const char* what, std::uint64_t done, std::uint64_t total, const char*) {
            if (progress && std::string_view(what) == "files") progress(done, total);
        };
        report.verification = verify_bake(list_folder(folder.root()), strip_key, options);
        return false;
    });
}

void measure_kept(const BakeFolder& folder, BakeReport& report) {
    for (StageReport& stage : report.stages)
        for (KeptResult& result : stage.kept) result.bytes = folder.bytes_of(result.name);
}

}  // namespace

BakeReport bake(const BakeOptions& wanted) {
    BakeOptions options = wanted;
    check_paths(options);
    check_layers(options);
    const ThreadLimit threads(options.threads);
    const BakeFolder folder(options.work, options.output);
    BakeReport report;
    report.budget_bytes = options.memory_bytes;
    report.store = store_name(options.store);
    StageClock clock(options, report);

    const auto geometry = prepare_geometry(options, folder, clock, report);
    report.geometry_bytes = geometry->resident_bytes();
    if (options.adapt) {
        clock.stage("adapt", [&] {
            double seconds = 0;
            for (const StageReport& stage : report.stages) seconds += stage.seconds;
            options.adapt(options, *geometry, seconds);
            return false;
        });
        check_layers(options);
    }
    for (Decision& decision : decide(options, *geometry))
        if (!decision.runs) report.skipped.emplace_back(std::move(decision.part), std::move(decision.why));
    const MemoryPlan plan = plan_memory(options.memory_bytes, memory_demand(options, *geometry, report, threads.threads()));
    report.floor_bytes = plan.floor_bytes;

    // Matrix and solution are gone before the pictures come: the floor counts only one of them.
    Key strip_key;
    const BakedLight light = [&] {
        const SolvedScene solved = solve_in_rounds(options, *geometry, folder, plan, clock, report);
        strip_key = solved.matrix.strip_key;
        BakedLight texels = light_texels(options, *geometry, solved.sources, solved.matrix, solved.solution, folder, clock, report);
        if (solved.matrix.rows) report.rays_traced += solved.matrix.rows->rays_traced();
        return texels;
    }();
    if (options.verify && is_stopping(options)) note_stop(report, "verify", "the bake folder was not checked");
    else if (options.verify) verify(folder, strip_key, plan, clock, report);
    write_outputs(options, *geometry, light, clock, report);
    warn_of_stop(options, report);
    measure_kept(folder, report);
    return report;
}

}  // namespace luxel
