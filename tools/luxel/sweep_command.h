/// luxel sweep: one scene baked with many settings, and what each costs and gets wrong.
#pragma once
#include <CLI/App.hpp>

namespace luxel {

/// Adds the command to the program; it runs when the command line is parsed. The exit code is 0, 6 where no point meets the targets, or 130
/// when it was interrupted.
void add_sweep_command(CLI::App& program, int& exit_code);

}  // namespace luxel
