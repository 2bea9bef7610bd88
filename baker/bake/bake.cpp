#include "baker/bake/bake.h"

#include <malloc.h>

#include "baker/bake/geometry_stages.h"
#include "baker/bake/light_stages.h"
#include "baker/bake/matrix_stages.h"
#include "baker/bake/memory_plan.h"
#include "baker/bake/write_stage.h"
#include "baker/core/memory.h"
#include "baker/core/parallel.h"
#include "formats/base/file.h"
#include "formats/image/image_file.h"

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
    if (!std::filesystem::exists(options.input, ignored))
        throw Error(ErrorCode::bad_input, options.input.string(), "no such file", "check the path");
    if (options.output.has_parent_path()) make_folder(options.output.parent_path());
}

}  // namespace

BakeReport bake(const BakeOptions& options) {
    check_paths(options);
    const ThreadLimit threads(options.threads);
    const BakeFolder folder(options.work, options.output);
    BakeReport report;
    report.budget_bytes = options.memory_bytes;
    StageClock clock(options, report);

    const auto geometry = prepare_geometry(options, folder, clock, report);
    report.geometry_bytes = geometry->resident_bytes();
    ::malloc_trim(0);  // what the stages have freed is not needed, and would make the floor a matter of luck
    const std::uint64_t resident = resident_bytes_now();
    const std::uint64_t fixed = resident > report.geometry_bytes ? resident - report.geometry_bytes : 0;
    const MemoryPlan plan =
        plan_memory(options.memory_bytes, fixed, geometry->patches.count(), options.chunk_patches,
                    geometry->atlas.page_size, threads.threads(), image_library_is_loaded());
    report.floor_bytes = plan.floor_bytes;

    // Matrix and solution are gone before the image library comes: the floor counts only one of them.
    const BakedLight light = [&] {
        const BakedMatrix matrix = prepare_matrix(options, *geometry, folder, plan, clock, report);
        const BakedSolution solution = solve_patches(options, *geometry, matrix, folder, plan, clock, report);
        return light_texels(options, *geometry, matrix, solution, folder, clock, report);
    }();
    write_outputs(options, *geometry, light, clock, report);
    return report;
}

}  // namespace luxel
