#include "tools/luxel/bake_command.h"

#include <fmt/format.h>

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <chrono>
#include <memory>

#include "baker/bake/bake.h"
#include "formats/base/file.h"
#include "tools/luxel/bake_options.h"
#include "tools/luxel/inspect_text.h"
#include "tools/luxel/interrupt.h"
#include "tools/luxel/progress_printer.h"
#include "tools/luxel/quality_ladder.h"
#include "tools/luxel/report_json.h"
#include "tools/luxel/warning_printer.h"

namespace luxel {
namespace {

void print_summary(const BakeReport& report, const BakeOptions& options) {
    double seconds = 0;
    for (const StageReport& stage : report.stages) seconds += stage.seconds;
    const std::string error =
        report.standard_error ? fmt::format("standard error {:.1f} %, ", 100 * *report.standard_error) : std::string();
    fmt::print("{}: {} triangles, {} texels on {} page{}{}, {} patches, {} pairs; {}{} to {:.1e} {}; {:.1f} s, {} MB\n",
               options.output.string(), report.triangles, report.texels, report.pages, report.pages == 1 ? "" : "s", picture_error_text(report, options),
               report.patches, report.pairs, error, report.stopped ? "stopped, solved" : "solved", report.error_bound,
               report.solve_path, seconds, report.peak_bytes >> 20);
}

/// Says what --target-seconds chose. Returns the settings with it.
std::vector<std::pair<std::string, std::string>> settings_of_choice(BakeArguments arguments, const TimeChoice& choice, BakeOptions& options, BakeReport& report) {
    take(choice.chosen, options);
    arguments.quality = choice.chosen.name.substr(0, choice.chosen.name.find(' '));
    const double seconds = choice.foreseen.seconds.total();
    const std::string text = fmt::format("--quality {}, foreseen to take {:.3g} s", choice.chosen.name, seconds);
    if (seconds > arguments.target_seconds)
        report.warnings.push_back({"target-not-reached", "--target-seconds", fmt::format("{:g} s are not enough for any quality: {}", arguments.target_seconds, text)});
    else if (!arguments.quiet)
        fmt::print("--target-seconds {:g}: {}\n", arguments.target_seconds, text);
    return bake_settings(arguments, options);
}

int exit_code(const BakeReport& report, const StopRequest& stop) {
    if (report.stopped && stop.was_asked()) return exit_interrupted;
    return report.converged && !report.stopped ? 0 : static_cast<int>(ErrorCode::stopped_early);
}

int run(const BakeArguments& arguments, const CLI::App& command) {
    StopRequest stop;
    ask_stop_after(arguments, command, stop);
    const InterruptGuard guard(stop);
    BakeOptions options = resolve_bake_options(arguments, command);
    options.stop = &stop;
    TimeChoice choice;
    adapt_to_seconds(options, arguments, command, choice);
    ProgressPrinter printer(arguments.quiet);
    options.progress = [&](const std::string& stage, std::uint64_t done, std::uint64_t total, const char* unit) {
        printer.update(stage, done, total, unit);
    };
    BakeReport report = bake(options);
    printer.finish();
    report.settings = options.adapt ? settings_of_choice(arguments, choice, options, report) : bake_settings(arguments, options);
    print_warnings(report.warnings);
    if (!arguments.report.empty()) {
        const std::string text = report_json(report);
        publish_file(arguments.report, {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
    }
    if (!arguments.quiet) print_summary(report, options);
    if (report.verification && !report.verification->passed()) {
        std::fflush(stdout);
        print_findings(*report.verification);
        return static_cast<int>(ErrorCode::damaged_store);
    }
    return exit_code(report, stop);
}

}  // namespace

void add_bake_command(CLI::App& program, int& exit_code) {
    CLI::App* command = program.add_subcommand("bake", "Bake the light of a glTF scene into lightmaps");
    const auto arguments = std::make_shared<BakeArguments>();
    add_bake_options(*command, *arguments);
    add_target_seconds(*command, *arguments);
    command->add_option("-o,--output", arguments->output, "result, .glb or .gltf")->required()->type_name("OUT");
    command->footer(
        "Examples:\n"
        "  luxel bake hall.glb -o out/hall.glb\n"
        "  luxel bake hall.glb -o out/hall.glb --quality draft --texels-per-metre 4\n"
        "  luxel bake hall.glb -o out/hall.glb --quality high --work hall.bake --report hall.json\n"
        "  luxel bake house.glb -o out/house.gltf --uv keep --atlas-size 2048\n"
        "  luxel bake city.glb -o out/city.glb --memory 1G --threads 2\n");
    command->callback([arguments, command, &exit_code] { exit_code = run(*arguments, *command); });
}

}  // namespace luxel
