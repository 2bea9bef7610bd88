#include "baker/solver/solve.h"

#include <algorithm>
#include <array>

#include "baker/solver/conjugate.h"
#include "baker/solver/gather.h"
#include "baker/solver/shoot.h"
#include "baker/solver/shoot_patch.h"

namespace luxel {
namespace {

constexpr std::array<std::string_view, 5> names{"shoot", "shoot-patch", "gather", "jacobi",
                                                "cg"};  // in the order of SolverKind

}  // namespace

std::span<const std::string_view> solver_names() { return names; }

std::optional<SolverKind> solver_kind(std::string_view name) {
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end()) return std::nullopt;
    return static_cast<SolverKind>(found - names.begin());
}

SolveResult solve(SolverKind kind, BlockSource& source, const SolveInput& input, const SolveOptions& options) {
    switch (kind) {
        case SolverKind::shoot:
            return solve_by_shooting(source, input, options);
        case SolverKind::shoot_patch:
            return solve_by_shooting_patches(source, input, options);
        case SolverKind::gather:
            return solve_by_gathering(source, input, options);
        case SolverKind::jacobi:
            return solve_by_jacobi(source, input, options);
        case SolverKind::cg:
            return solve_by_conjugate_gradients(source, input, options);
    }
    return {};
}

}  // namespace luxel
