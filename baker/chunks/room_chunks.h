/// Cuts the patches into chunks that are rooms: sets that see each other much and others little, found by a thin round
/// of rays before any evidence exists.
///
/// 1. Cells of surface exchange a few rays per patch (sight_graph.h).
/// 2. What sees each other most is joined as long as it fits into a chunk (room_tree.h): a room that does not fit ends
///    as several chunks, small rooms share one.
/// 3. A chunk whose parts see more of other chunks with space than of each other is given to them.
/// 4. Small chunks that are left, such as outer faces which see nothing, are put together by place (space_halving.h).
///
/// Deterministic, and local: a moved chair changes the rays between what it left or entered and what sees that, hence
/// the chunks of its room and, through their sizes, perhaps those of the next ones. Thread count and memory budget have
/// no influence.
#pragma once
#include "baker/chunks/sight_graph.h"
#include "baker/chunks/spatial_tiles.h"

namespace luxel {

struct RoomOptions {
    std::uint32_t chunk_patches = 2048;  ///< at most; 1 to 65536. Independent of the memory budget.
    float patch_side_m = 0.25f;          ///< about; > 0: cells are four to eight patches wide
    std::uint32_t rays_per_patch = 8;    ///< of the thin round: an eighth of the first round of evidence
};

/// Inside a chunk the old order (spatial_tiles.h). Threads: uses them all.
Tiling find_room_chunks(const Scene& scene, const Atlas& atlas, const PatchSet& patches, const Tracer& tracer,
                        const RoomOptions& options);

/// Steps 2 to 4: the chunks as lists of patches, each ascending, in the order of their first patches. Pure.
/// `limit` > 0: patches per chunk.
std::vector<std::vector<PatchNumber>> group_into_rooms(const SightCells& cells, const SightGraph& graph,
                                                       std::uint32_t limit);

}  // namespace luxel
