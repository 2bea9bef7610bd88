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

/// What a bake will hold.
struct MemoryDemand {
    std::uint64_t fixed_bytes = 0;      ///< resident now beside the geometry: program, libraries
    std::uint64_t past_peak_bytes = 0;  ///< and at most so far: a sky's picture may be large before it is averaged
    std::uint64_t patch_count = 0;
    std::uint32_t chunk_patches = 16, page_size = 64, page_count = 1;
    unsigned threads = 1;
    SolverKind solver = SolverKind::shoot;  ///< solvers hold more or less per patch
    bool gathers = false;                   ///< light is gathered at texels
    bool refines = false;                   ///< and again where it is uncertain
    bool previews = false;                  ///< pictures are written while the light is solved
    std::uint64_t seam_bytes = 0;           ///< of joining seams (output/seam_join.h), before the pictures are written
    std::uint64_t layer_bytes_per_texel = 0;  ///< of what is written beside the lightmap (output/layers.h)
    std::uint64_t picture_bytes_per_texel = 0;  ///< of each page's picture, kept until the model is written
    std::uint32_t sky_width = 0, sky_height = 0;  ///< pixels of the sky; 0: there is none
    bool has_tinting_panes = false;               ///< light/pane_colour.h
};

/// Pure. Throws Error{budget_too_small} stating the smallest budget when the given one is below the floor.
MemoryPlan plan_memory(std::uint64_t budget_bytes, const MemoryDemand& demand);

/// The smallest budget alone. Pure.
std::uint64_t memory_floor(const MemoryDemand& demand);

}  // namespace luxel
