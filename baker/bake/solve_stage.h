/// Radiosity of the patches from a matrix and the scene's light.
#pragma once
#include <memory>

#include "baker/bake/matrix_stages.h"
#include "baker/formfactors/sky_in_view.h"
#include "baker/solver/solver.h"

namespace luxel {

/// Light that the equation starts from; the same for every matrix of the scene.
struct BakedSources {
    std::vector<Rgb> lamp_irradiance;  ///< direct light of lamps and sky per patch, lux
    std::unique_ptr<const SkyInView> sky;  ///< null: no patch sees any: neither will texels sample it
    std::vector<Channels> emission;    ///< M: self-emission plus what is reflected of lamps and sky, lm/m2
};

/// Radiosity per patch with everything that a texel needs of it.
struct BakedSolution {
    SolveResult result;
    std::vector<Rgb> reflectance;  ///< per patch, as solved with (endless_light.h)
    Key key;               ///< of the whole solution
    bool is_whole = true;  ///< false: it was stopped before its tolerance, and is not in the bake folder
};

class Preview;

/// Stage "lamps", and those of the sky (sky_stage.h).
BakedSources light_patches(const BakeOptions& options, const BakedGeometry& geometry, const BakeFolder& folder, StageClock& clock,
                           BakeReport& report);

/// Name of the solution of a matrix.
Key solution_key(const BakeOptions& options, const BakedGeometry& geometry, const Key& matrix_key, double tolerance);

/// Stage "solve". Goes on from a checkpoint of the same solution if the bake folder has one. `preview` may be null.
BakedSolution solve_patches(const BakeOptions& options, const BakedGeometry& geometry, const BakedSources& sources,
                            const BakedMatrix& matrix, double tolerance, const BakeFolder& folder, Preview* preview,
                            StageClock& clock, BakeReport& report);

}  // namespace luxel
