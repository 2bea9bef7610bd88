/// What --memory buys. Budget = everything resident except the scene's geometry (BakedGeometry::resident_bytes).
/// The budget decides only how much is kept at once, never a result.
#pragma once
#include <cstdint>

#include "baker/solver/solve.h"

namespace luxel {

struct MemoryPlan {
    std::uint64_t floor_bytes = 0;    ///< smallest budget that works for this scene
    std::uint64_t pooling_bytes = 0;  ///< buckets and sorting
    std::uint64_t cache_bytes = 0;    ///< decoded blocks kept by the solver
};

/// `fixed_bytes`: resident now beside the geometry (program, libraries); `image_library_loaded`: is the image library among
/// them? `solver`: solvers hold more or less per patch. `seam_bytes`: joining them (output/seam_join.h), before the pictures are written. `previews`: pictures are written while the light is solved. Pure. Throws Error{budget_too_small} stating the
/// smallest budget when the given one is below the floor.
MemoryPlan plan_memory(std::uint64_t budget_bytes, std::uint64_t fixed_bytes, std::uint64_t patch_count,
                       std::uint32_t chunk_patches, std::uint32_t page_size, unsigned threads,
                       bool image_library_loaded, SolverKind solver, std::uint64_t seam_bytes, bool previews = false);

}  // namespace luxel
