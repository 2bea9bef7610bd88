#include "tools/luxel/sweep_command.h"

#include <fmt/format.h>

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <memory>

#include "baker/sweep/bake_child.h"
#include "baker/sweep/sweep.h"
#include "baker/sweep/sweep_page.h"
#include "baker/sweep/sweep_tables.h"
#include "formats/base/error.h"
#include "formats/base/file.h"
#include "tools/luxel/bake_options.h"
#include "tools/luxel/interrupt.h"
#include "tools/luxel/printable.h"
#include "tools/luxel/size_option.h"
#include "tools/luxel/sweep_inputs.h"

namespace luxel {
namespace {

struct Arguments {
    BakeArguments bake;
    std::string folder, grid = grid_names().front(), target_disk;
    std::vector<std::string> reference;
    std::uint32_t repeats = 1;
    bool keep_work = false;
    double target_error = 0, target_seconds = 0;
};

std::vector<GridPoint> grid_of(const std::string& grid) {
    if (std::ranges::find(grid_names(), grid) != grid_names().end()) return named_grid(grid);
    std::error_code ignored;
    if (!std::filesystem::exists(grid, ignored)) {
        std::string known;
        for (const std::string& name : grid_names()) known += (known.empty() ? "" : ", ") + name;
        throw Error(ErrorCode::bad_input, "--grid", "no such file, and no grid of the program: " + grid, "known are " + known);
    }
    return parse_grid(read_file(grid), grid);
}

SweepTargets targets_of(const Arguments& a, const CLI::App& command) {
    SweepTargets targets;
    if (command.count("--target-error")) targets.error = a.target_error;
    if (command.count("--target-seconds")) targets.seconds = a.target_seconds;
    if (command.count("--target-disk")) targets.disk_bytes = parse_bytes(a.target_disk, "--target-disk");
    return targets;
}

void publish_text(const std::filesystem::path& path, const std::string& text) {
    publish_file(path, {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

void publish(const SweepOptions& options, const SweepResult& result, const SweepSummary& summary) {
    publish_text(options.folder / "sweep.csv", sweep_csv(result));
    publish_text(options.folder / "sweep.json", sweep_json(result, summary));
    publish_text(options.folder / "sweep.html", sweep_page(result, summary));
}

void check_paths(const Arguments& a) {
    std::error_code ignored;
    if (!std::filesystem::exists(a.bake.input, ignored)) throw Error(ErrorCode::bad_input, a.bake.input, "no such file", "check the path");
    if (std::filesystem::exists(a.folder, ignored) && !std::filesystem::is_directory(a.folder, ignored))
        throw Error(ErrorCode::cannot_write, a.folder, "expected a folder, found a file", "a sweep writes several files: name a folder");
    make_folder(a.folder);
}

/// What the user asked for, on standard output; the exit code.
int tell_choice(const SweepSummary& summary) {
    if (!summary.targets.any()) return 0;
    if (!summary.chosen) {
        std::fflush(stdout);
        fmt::print(stderr, "luxel: no measured point meets the targets\n");
        return static_cast<int>(ErrorCode::stopped_early);
    }
    fmt::print("{}\n", summary.chosen->bake_line);
    return 0;
}

SweepOptions options_of(const Arguments& arguments, const CLI::App& command, const StopRequest& stop) {
    SweepOptions options;
    options.common = given_settings(command);
    options.reference_common = settings_of_reference(options.common);
    options.points = grid_of(arguments.grid);
    check_points(arguments.bake, options.common, options.points);
    check_paths(arguments);
    options.program = own_program();
    options.scene = arguments.bake.input;
    options.folder = arguments.folder;
    options.reference_pages.assign(arguments.reference.begin(), arguments.reference.end());
    options.repeats = arguments.repeats;
    options.inputs = sweep_key(arguments.bake);
    options.keep_work = arguments.keep_work;
    options.stop = &stop;
    if (!arguments.bake.quiet) options.progress = [](const std::string& line) { fmt::print(stderr, "luxel: {}\n", printable(line)); };
    return options;
}

int run(const Arguments& arguments, const CLI::App& command) {
    SweepSummary summary;
    summary.targets = targets_of(arguments, command);
    StopRequest stop;
    const InterruptGuard guard(stop);
    const SweepOptions options = options_of(arguments, command, stop);
    const SweepResult result = run_sweep(options);
    if (!result.points.empty() && std::ranges::all_of(result.points, &PointResult::failed))
        throw Error(ErrorCode::bad_input, arguments.bake.input, "no point could be baked; the first one: " + result.points.front().message, "luxel bake with the same options says more");
    summary.software = "luxel " LUXEL_VERSION;
    summary.scene = options.scene.filename().string();
    for (const BakeSetting& s : options.common) summary.common.emplace_back(s.option, s.value);
    summary.chosen = choose_point(result.points, summary.targets);
    if (!summary.targets.any()) summary.chosen = nullptr;
    publish(options, result, summary);
    if (!arguments.bake.quiet) {
        const std::vector<bool> front = find_fronts(result.points).seconds;
        fmt::print("{}: {} of {} points, {} of them measured before, {} on the front of error against time\n", (options.folder / "sweep.html").string(), result.points.size(),
                   options.points.size(), result.found, std::ranges::count(front, true));
    }
    if (result.interrupted) return exit_interrupted;
    return tell_choice(summary);
}

}  // namespace

void add_sweep_command(CLI::App& program, int& exit_code) {
    CLI::App* command = program.add_subcommand("sweep", "Bake a scene with many settings; show what each costs and how far its light is from a reference");
    const auto arguments = std::make_shared<Arguments>();
    add_bake_options(*command, arguments->bake);
    command->add_option("-o,--output", arguments->folder, "folder for sweep.html, sweep.csv and sweep.json; a sweep that was interrupted goes on there")->required()->type_name("DIR");
    command->add_option("--grid", arguments->grid, "settings to try: default, rays, presets, or a file (docs/sweep.md)")->type_name("GRID|FILE")->capture_default_str()->group("Sweep");
    command->add_option("--reference", arguments->reference, "linear irradiance to measure against, a picture of floats for each page; otherwise two bakes at --quality reference")
        ->allow_extra_args(false)->type_name("FILE")->group("Sweep");
    command->add_option("--repeats", arguments->repeats, "bakes of each point, of which the median counts")->check(CLI::Range(1u, 99u))->capture_default_str()->group("Sweep");
    command->add_flag("--keep-work", arguments->keep_work, "leave the shared bake folders, for other grids to come")->group("Sweep");
    command->add_option("--target-error", arguments->target_error, "name the fastest point with at most this relative error, such as 0.02")->check(CLI::Range(1e-9, 1e9))->group("Sweep");
    command->add_option("--target-seconds", arguments->target_seconds, "name the point with the least error in this time")->check(CLI::Range(1e-9, 1e9))->group("Sweep");
    command->add_option("--target-disk", arguments->target_disk, "the same with at most this much in the bake folder, K/M/G")->group("Sweep");
    command->footer(
        "Takes the options of luxel bake too: they hold for all points that do not say otherwise.\n"
        "Examples:\n"
        "  luxel sweep hall.glb -o hall.sweep\n"
        "  luxel sweep hall.glb -o hall.sweep --grid presets --texels-per-metre 8\n"
        "  luxel sweep hall.glb -o hall.sweep --target-error 0.02\n");
    command->callback([arguments, command, &exit_code] { exit_code = run(*arguments, *command); });
}

}  // namespace luxel
