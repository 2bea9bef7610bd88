/// Parses the command line, runs a command, and is the one place that turns an Error into a message and an exit code.
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <cstdio>
#include <new>

#include "formats/base/error.h"
#include "tools/luxel/bake_command.h"

namespace {

int report(const luxel::Error& error) {
    std::fprintf(stderr, "luxel: error: %s: %s\n", error.where.c_str(), error.what_text.c_str());
    if (!error.hint.empty()) std::fprintf(stderr, "       %s\n", error.hint.c_str());
    return static_cast<int>(error.code);
}

int parse_and_run(int argc, char** argv) {
    int exit_code = 0;
    CLI::App program("luxel: out-of-core lightmap baker for glTF scenes", "luxel");
    program.set_version_flag("--version", "luxel " LUXEL_VERSION);
    program.require_subcommand(1);
    luxel::add_bake_command(program, exit_code);
    try {
        program.parse(argc, argv);
    } catch (const CLI::Success& done) {
        return program.exit(done);  // --help, --version
    } catch (const CLI::ParseError& error) {
        std::fprintf(stderr, "luxel: error: command line: %s\n       luxel bake --help lists all options\n", error.what());
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
        return report({luxel::ErrorCode::internal, "luxel", error.what(), "this is a fault of luxel; please report it"});
    }
}
