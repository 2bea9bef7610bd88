/// All solvers, for tests that ask the same of each.
#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "baker/solver/solve.h"

namespace luxel::test {

inline auto all_solvers() {
    return testing::Values(SolverKind::shoot, SolverKind::shoot_patch, SolverKind::gather, SolverKind::jacobi, SolverKind::cg);
}

/// The solver's name as part of a test's: letters, digits and underscores.
inline std::string solver_test_name(const testing::TestParamInfo<SolverKind>& kind) {
    std::string name(solver_names()[static_cast<std::size_t>(kind.param)]);
    std::replace(name.begin(), name.end(), '-', '_');
    return name;
}

}  // namespace luxel::test
