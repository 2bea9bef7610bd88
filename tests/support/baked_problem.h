/// A scene as far as the equation: what benches and figures of solvers start from, without a file of luxel's own.
#pragma once
#include <memory>
#include <vector>

#include "baker/bake/solve_stage.h"

namespace luxel::test {

/// B = M + rho / A * G B of a scene, and the geometry that its light goes back to.
struct BakedProblem {
    std::unique_ptr<BakedGeometry> geometry;
    BakedMatrix matrix;
    BakedSources sources;          ///< with M per patch, lm/m2
    std::vector<Rgb> reflectance;  ///< per patch, 0..1
    BakeReport report;             ///< of the stages up to the matrix
};

/// Every patch sends options.rays; nothing is left on importance, so that the matrix does not depend on light. Keeps its
/// stages in options.work, or uses those that are there. Throws what the stages throw.
BakedProblem bake_to_matrix(const BakeOptions& options);

}  // namespace luxel::test
