/// What a sweep reads of the report of one bake (docs/report.md).
///
/// Threads  pure.  Errors  Error{bad_input} naming the file and the member that is missing or of another kind.
#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "formats/base/bytes.h"

namespace luxel {

struct RunStage {
    std::string name;
    double seconds = 0;
    std::uint64_t peak_bytes = 0;
    bool reused = false;
    std::map<std::string, std::uint64_t> kept;  ///< name in the bake folder -> bytes when the bake ended
    double processor_seconds = 0;                ///< of all threads
};

/// What does not depend on the machine.
struct RunFigures {
    std::uint64_t texels = 0, patches = 0, evidence_rays = 0;
    double rays_per_texel = 0;  ///< of gathering; 0: nothing was gathered
    double patch_error = -1;    ///< predicted standard error of the patches' light, relative; -1: not known
    bool is_whole = true;       ///< converged, and not stopped
    double picture_median = 0, picture_p95 = 0;  ///< what encoding lost, of the worst page (OutputReport::error)
};

struct BakeRun {
    std::vector<RunStage> stages;
    std::uint64_t pages = 0;
    RunFigures figures{};
};

BakeRun parse_bake_run(ByteView report, const std::string& where);

/// What the bake folder holds for this bake alone, bytes.
std::uint64_t disk_bytes(const BakeRun& run);

}  // namespace luxel
