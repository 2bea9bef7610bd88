#include "tools/luxel/inspect_command.h"

#include <fmt/format.h>

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <CLI/Validators.hpp>
#include <memory>

#include "baker/core/parallel.h"
#include "formats/base/file.h"
#include "tools/luxel/inspect_text.h"
#include "tools/luxel/progress_printer.h"
#include "tools/luxel/size_option.h"

namespace luxel {
namespace {

struct Arguments {
    std::string folder, key, json, memory = "256M";
    std::size_t rows = 5;
    unsigned threads = 0;
    bool verify = false, quiet = false;
};

/// Looks at the matrix; with --verify damage is a finding, without it the error that it is.
void look(const Arguments& a, InspectReport& report, ProgressPrinter& printer) {
    VerifyOptions options;
    options.memory_bytes = parse_bytes(a.memory, "--memory");
    options.progress = [&](const char* what, std::uint64_t done, std::uint64_t total, const char* unit) {
        printer.update(what, done, total, unit);
    };
    const bool has_matrix = !report.listing.bakes.empty();
    if (!has_matrix && !a.key.empty()) choose_bake(report.listing, a.key);  // says what is missing
    const Key key = has_matrix ? choose_bake(report.listing, a.key) : Key{};
    if (a.verify) report.verify = has_matrix ? verify_bake(report.listing, key, options) : verify_files(report.listing, options);
    if (!has_matrix) return;
    try {
        const StoredMatrix matrix(report.listing, key);
        report.matrix = inspect_matrix(report.listing, matrix, a.rows, [&](std::uint64_t done, std::uint64_t total) {
            printer.update("read", done, total, "blocks");
        });
    } catch (const Error&) {
        if (!report.verify || report.verify->passed()) throw;
    }
}

int run(const Arguments& a) {
    const ThreadLimit threads(a.threads);
    InspectReport report;
    report.listing = list_folder(a.folder);
    ProgressPrinter printer(!a.verify || a.quiet);
    look(a, report, printer);
    printer.finish();
    if (!a.json.empty()) {
        const std::string text = inspect_json(report);
        if (a.json == "-")
            fmt::print("{}", text);
        else
            publish_file(a.json, {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
    }
    if (a.json != "-" && !a.quiet) fmt::print("{}", inspect_text(report));
    if (!report.verify || report.verify->passed()) return 0;
    std::fflush(stdout);
    print_findings(*report.verify);
    return static_cast<int>(ErrorCode::damaged_store);
}

}  // namespace

void add_inspect_command(CLI::App& program, int& exit_code) {
    CLI::App* command = program.add_subcommand("inspect", "Show what is in a bake folder, and check it");
    const auto a = std::make_shared<Arguments>();
    command->add_option("folder", a->folder, "bake folder, as given to luxel bake --work")->required()->type_name("BAKE_FOLDER");
    command->add_flag("--verify", a->verify, "check every block, recount the evidence, check closure and sampler; exit code 5 if anything is wrong");
    command->add_option("--key", a->key, "first digits of the matrix to look at (the newest)")->type_name("KEY");
    command->add_option("--rows", a->rows, "largest rows to list")->check(CLI::Range(std::size_t{0}, std::size_t{1000000}))->capture_default_str();
    command->add_option("--json", a->json, "write everything as JSON; - for standard output")->type_name("FILE");
    command->add_option("--memory", a->memory, "counts held at once by --verify, K/M/G")->capture_default_str();
    command->add_option("--threads", a->threads, "0: all cores")->check(CLI::Range(0u, 1024u))->capture_default_str();
    command->add_flag("-q,--quiet", a->quiet, "no progress, no text");
    command->footer(
        "Examples:\n"
        "  luxel inspect hall.luxel\n"
        "  luxel inspect hall.luxel --verify\n"
        "  luxel inspect hall.luxel --key 3f2a --json -\n");
    command->callback([a, &exit_code] { exit_code = run(*a); });
}

}  // namespace luxel
