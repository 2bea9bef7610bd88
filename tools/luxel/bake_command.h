/// `luxel bake IN -o OUT`: options, presets and their checks.
#pragma once
#include <CLI/App.hpp>

namespace luxel {

/// Adds the command to the program; it runs when the command line is parsed. The exit code of a run that ends without an
/// Error is 0, or 6 when the solve stopped before its tolerance.
void add_bake_command(CLI::App& program, int& exit_code);

}  // namespace luxel
