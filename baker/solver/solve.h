/// The solvers by name.
#pragma once
#include <optional>
#include <span>
#include <string_view>

#include "baker/solver/solver.h"

namespace luxel {

enum class SolverKind { shoot, shoot_patch, gather, jacobi, cg };

/// As in options and reports: shoot, shoot-patch, gather, jacobi, cg.
std::span<const std::string_view> solver_names();
std::optional<SolverKind> solver_kind(std::string_view name);

/// shoot.h, shoot_patch.h, gather.h, conjugate.h.
SolveResult solve(SolverKind kind, BlockSource& source, const SolveInput& input, const SolveOptions& options);

}  // namespace luxel
