/// What a bake did: the plain data behind --report. tools/luxel/report_json writes it; docs/report.md is its schema.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "baker/bake/verify.h"
#include "baker/formfactors/closure.h"
#include "baker/output/picture_error.h"
#include "formats/base/error.h"

namespace luxel {

/// A file or folder of the bake folder that holds the result of a stage.
struct KeptResult {
    std::string name;         ///< stage and hash of all inputs (bake_folder.h): who has the same name has the same result
    std::uint64_t bytes = 0;  ///< when the bake ended; 0: it was of use only on the way
};

struct StageReport {
    std::string name;
    double seconds = 0;
    double processor_seconds = 0;    ///< of all threads
    std::uint64_t peak_bytes = 0;    ///< highest resident size during the stage
    bool reused = false;             ///< its result was in the bake folder
    std::vector<KeptResult> kept{};  ///< empty: it keeps nothing
};

/// What was cut short.
struct StopReport {
    std::string where;  ///< stage
    std::string what;   ///< what of it is there
};

struct OutputReport {
    std::string path, kind, quantity, unit, encoding;
    double intensity = 1;
    std::optional<PictureError> error{};  ///< of a picture in the model, against the float page
};

/// What gathering found at the texels that have light of their own (light/texel_light.h).
struct GatherReport {
    double rays_per_texel = 0;                ///< mean
    double median_error = 0, p95_error = 0;  ///< of TexelLight::error
};

/// What joining the seams of the lightmaps did (output/seam_join.h, output/seam_samples.h).
struct SeamReport {
    bool joined = false;
    std::uint64_t seams = 0;                             ///< stretches where borders of charts meet
    std::uint64_t points = 0;                            ///< compared along them
    std::uint64_t blocked = 0, hidden = 0, crowded = 0;  ///< points left out
    std::uint64_t texels = 0;                            ///< changed
    double length_m = 0;                                 ///< of what is joined
    double jump_before = 0, jump_after = 0;              ///< mean of |a - b| over the mean light there
};

/// Of the second model, which any viewer shows (unlit_stage.h).
struct UnlitReport {
    double exposure = 1;   ///< sample = nits * exposure, before the sRGB curve
    double cut_share = 0;  ///< of all channels, what is brighter than white
};

/// Two-sided surfaces whose front lies in the dark while their back does not (light/lit_sides.h).
struct DarkFrontReport {
    std::uint64_t charts = 0;
    double area_m2 = 0, area_share = 0;  ///< the latter of the whole scene
    bool turned = false;                 ///< their texels hold the light of the back
};

struct BakeReport {
    std::vector<std::pair<std::string, std::string>> settings;  ///< name, value as text

    std::uint64_t triangles = 0, charts = 0, pages = 0, texels = 0, patches = 0, chunks = 0, blocks = 0, pairs = 0;
    double texels_per_metre = 0;
    DarkFrontReport dark_fronts;
    std::string store;              ///< all, hot or none
    std::uint64_t store_bytes = 0;  ///< of the matrix on disk
    std::uint64_t rays_traced = 0;  ///< by this run, for evidence, blocks and accuracy: as often as they were traced
    std::uint64_t evidence_rays = 0, evidence_rounds = 0;
    double evidence_seconds = 0;
    /// Relative, of the patches' light (accuracy/standard_error.h). None where the estimator's counts do not scatter.
    std::optional<double> standard_error;
    std::uint64_t least_rays = 0, most_rays = 0;  ///< of one patch
    ClosureReport closure;

    std::string solver;
    std::string solve_path;      ///< "in memory" or "out of core"
    std::string solve_path_why;  ///< with figures
    bool checkpoint_resumed = false;  ///< a solve of this run went on from a checkpoint
    double reads = 0, error_bound = 0;
    bool converged = true;
    std::vector<std::pair<std::uint64_t, double>> history;  ///< bytes read, error bound

    std::array<double, 3> emitted_lm{}, absorbed_lm{}, lost_lm{};

    SeamReport seams;
    std::optional<GatherReport> gathering;  ///< none where nothing was gathered, or not all

    std::optional<StopReport> stopped;  ///< none: everything that was wanted is there
    std::uint64_t previews = 0;         ///< written
    double preview_seconds = 0;

    std::vector<StageReport> stages;
    std::uint64_t budget_bytes = 0, peak_bytes = 0, geometry_bytes = 0, floor_bytes = 0;
    std::optional<Verification> verification;  ///< of the bake folder, if it was wanted
    std::vector<Warning> warnings;
    std::vector<std::pair<std::string, std::string>> skipped;  ///< part, why
    std::vector<OutputReport> outputs;
    std::optional<UnlitReport> unlit;  ///< none: not wanted
};

}  // namespace luxel
