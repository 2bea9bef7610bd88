/// The last part of the way inside: solve for the patches, then light for every texel.
#pragma once
#include "baker/bake/matrix_stages.h"
#include "baker/solver/solver.h"

namespace luxel {

/// Radiosity per patch with everything that a texel needs of it.
struct BakedSolution {
    SolveResult result;
    std::vector<Rgb> lamp_irradiance;  ///< direct light of lamps per patch, lux
    Key key;
};

BakedSolution solve_patches(const BakeOptions& options, const BakedGeometry& geometry, const BakedMatrix& matrix,
                            const BakeFolder& folder, const MemoryPlan& plan, StageClock& clock, BakeReport& report);

/// Publishes the irradiance of every page in the bake folder; returns where.
struct BakedLight {
    std::filesystem::path folder;
    Key key;
};
BakedLight light_texels(const BakeOptions& options, const BakedGeometry& geometry, const BakedMatrix& matrix,
                        const BakedSolution& solution, const BakeFolder& folder, StageClock& clock, BakeReport& report);

}  // namespace luxel
