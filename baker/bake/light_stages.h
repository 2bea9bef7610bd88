/// The last part of the way inside: light for every texel.
#pragma once
#include "baker/bake/solve_stage.h"

namespace luxel {

/// Publishes the irradiance of every page in the bake folder; returns where.
struct BakedLight {
    std::filesystem::path folder;
    Key key;
};
BakedLight light_texels(const BakeOptions& options, const BakedGeometry& geometry, const BakedSources& sources,
                        const BakedMatrix& matrix, const BakedSolution& solution, const BakeFolder& folder,
                        StageClock& clock, BakeReport& report);

}  // namespace luxel
