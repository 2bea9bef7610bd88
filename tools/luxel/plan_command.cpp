#include "tools/luxel/plan_command.h"

#include <fmt/format.h>

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <array>
#include <memory>

#include "baker/plan/plan.h"
#include "formats/base/file.h"
#include "tools/luxel/bake_options.h"
#include "tools/luxel/interrupt.h"
#include "tools/luxel/plan_text.h"
#include "tools/luxel/progress_printer.h"
#include "tools/luxel/quality_ladder.h"
#include "tools/luxel/size_option.h"
#include "tools/luxel/warning_printer.h"

namespace luxel {
namespace {

constexpr std::array finding_codes{"uv1-unfit",        "below-a-texel", "crowding",       "bright-surfaces", "dark-lamps", "far-from-origin",
                                   "coincident-faces", "open-room",     "unlit-surfaces", "dark-fronts"};

struct Arguments {
    BakeArguments bake;
    std::string fail_on, target_disk;
};

/// The codes that --fail-on names; all of them for "any".
std::vector<std::string> codes_to_fail_on(const std::string& list) {
    std::vector<std::string> codes;
    std::string known;
    for (const char* code : finding_codes) known += (known.empty() ? "" : ", ") + std::string(code);
    for (std::size_t begin = 0; begin <= list.size() && !list.empty();) {
        const std::size_t end = std::min(list.find(',', begin), list.size());
        const std::string code = list.substr(begin, end - begin);
        if (code == "any") codes.insert(codes.end(), finding_codes.begin(), finding_codes.end());
        else if (std::ranges::find(finding_codes, code) == finding_codes.end())
            throw Error(ErrorCode::usage, "--fail-on", "\"" + code + "\" is not a finding", "known are any, " + known);
        else codes.push_back(code);
        begin = end + 1;
    }
    return codes;
}

PlanWishes wishes_of(const Arguments& arguments, const CLI::App& command) {
    return {.presets = all_presets(arguments.bake, command),
            .ladder = quality_ladder(arguments.bake, command),
            .seconds = arguments.bake.target_seconds,
            .disk_bytes = arguments.target_disk.empty() ? 0 : parse_bytes(arguments.target_disk, "--target-disk")};
}

int run(const Arguments& arguments, const CLI::App& command) {
    const std::vector<std::string> fatal = codes_to_fail_on(arguments.fail_on);
    StopRequest stop;
    ask_stop_after(arguments.bake, command, stop);
    const InterruptGuard guard(stop);
    BakeOptions options = resolve_bake_options(arguments.bake, command);
    options.stop = &stop;
    ProgressPrinter printer(arguments.bake.quiet);
    options.progress = [&](const std::string& stage, std::uint64_t done, std::uint64_t total, const char* unit) {
        printer.update(stage, done, total, unit);
    };
    const PlanReport plan = plan_bake(options, wishes_of(arguments, command));
    printer.finish();
    print_warnings(plan.warnings);
    if (!arguments.bake.report.empty()) {
        const std::string text = plan_json(plan, bake_settings(arguments.bake, options));
        publish_file(arguments.bake.report, {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
    }
    if (!arguments.bake.quiet) fmt::print("{}", plan_text(plan));
    const auto is_fatal = [&](const SceneFinding& finding) { return std::ranges::find(fatal, finding.code) != fatal.end(); };
    return std::ranges::any_of(plan.findings, is_fatal) ? exit_findings : 0;
}

}  // namespace

void add_plan_command(CLI::App& program, int& exit_code) {
    CLI::App* command = program.add_subcommand("plan", "Say what a bake would do and what is wrong with the scene, without baking");
    const auto arguments = std::make_shared<Arguments>();
    add_bake_options(*command, arguments->bake);
    add_target_seconds(*command, arguments->bake);
    command->add_option("--fail-on", arguments->fail_on, "findings that end with exit code 8, separated by commas, or any")->type_name("CODES")->group("Running");
    command->add_option("--target-disk", arguments->target_disk, "what the form factors may take, K/M/G: says what to do where they take more")->group("Running");
    command->footer(
        "Takes the options of luxel bake: put plan in place of bake, and leave out the output.\n"
        "Examples:\n"
        "  luxel plan hall.glb\n"
        "  luxel plan hall.glb --texels-per-metre 16 --report plan.json\n"
        "  luxel plan hall.glb --fail-on open-room,coincident-faces -q\n");
    command->callback([arguments, command, &exit_code] { exit_code = run(*arguments, *command); });
}

}  // namespace luxel
