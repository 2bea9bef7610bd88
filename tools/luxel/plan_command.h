/// luxel plan: what a bake would do, and what is wrong with the scene.
#pragma once
#include <CLI/App.hpp>

namespace luxel {

/// The scene has what --fail-on names: no error of the program, so no ErrorCode.
constexpr int exit_findings = 8;

void add_plan_command(CLI::App& program, int& exit_code);

}  // namespace luxel
