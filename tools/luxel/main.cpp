/// Parses the command line, runs a command, and is the one place that turns an Error into a message and an exit code.
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <cstdio>
#include <new>

#include "formats/base/error.h"
#include "tools/luxel/bake_command.h"
#include "tools/luxel/inspect_command.h"
#include "tools/luxel/plan_command.h"
#include "tools/luxel/printable.h"
#include "tools/luxel/sweep_command.h"

namespace {

/// What to do where the place that found the fault has nothing better to say.
const char* usual_hint(luxel::ErrorCode code) {
    switch (code) {
        case luxel::ErrorCode::usage: return "luxel bake --help, or that of another command, lists all options";
        case luxel::ErrorCode::bad_input: return "the file is damaged or does not follow its format; export it again";
        case luxel::ErrorCode::not_in_build: return "build luxel with this part";
        case luxel::ErrorCode::cannot_write: return "check the path, its permissions and the free space";
        case luxel::ErrorCode::damaged_store: return "remove the file and run the same command again";
        case luxel::ErrorCode::stopped_early: return "allow more reads or a larger tolerance";
        case luxel::ErrorCode::budget_too_small: return "use a larger --memory";
        case luxel::ErrorCode::internal: break;
    }
    return "this is a fault of luxel; please report it";
}

int report(const luxel::Error& error) {
    std::fprintf(stderr, "luxel: error: %s: %s\n", luxel::printable(error.where).c_str(), luxel::printable(error.what_text).c_str());
    std::fprintf(stderr, "       %s\n", error.hint.empty() ? usual_hint(error.code) : error.hint.c_str());
    return static_cast<int>(error.code);
}

int parse_and_run(int argc, char** argv) {
    int exit_code = 0;
    CLI::App program("luxel: out-of-core lightmap baker for glTF scenes", "luxel");
    program.set_version_flag("--version", "luxel " LUXEL_VERSION);
    program.require_subcommand(1);
    luxel::add_bake_command(program, exit_code);
    luxel::add_plan_command(program, exit_code);
    luxel::add_inspect_command(program, exit_code);
    luxel::add_sweep_command(program, exit_code);
    try {
        program.parse(argc, argv);
    } catch (const CLI::Success& done) {
        return program.exit(done);  // --help, --version
    } catch (const CLI::ParseError& error) {
        std::fprintf(stderr, "luxel: error: command line: %s\n       luxel bake --help, or that of another command, lists all options\n", error.what());
        return static_cast<int>(luxel::ErrorCode::usage);
    }
    return exit_code;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        return parse_and_run(argc, argv);
    } catch (const luxel::Error& error) {
        return report(error);
    } catch (const std::bad_alloc&) {
        return report({luxel::ErrorCode::internal, "memory", "the system has no more memory", "use a smaller --memory"});
    } catch (const std::exception& error) {
        return report({luxel::ErrorCode::internal, "luxel", error.what()});
    }
}
