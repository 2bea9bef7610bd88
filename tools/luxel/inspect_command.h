/// `luxel inspect BAKE_FOLDER`: what is in a bake folder, and whether it is whole.
#pragma once
#include <CLI/App.hpp>

namespace luxel {

/// Adds the command to the program; it runs when the command line is parsed. The exit code is 0, or 5 when --verify found
/// something wrong.
void add_inspect_command(CLI::App& program, int& exit_code);

}  // namespace luxel
