/// Who sees whom, coarsely: cells of surface, and how many rays of a thin round went between them. It exists before
/// chunks do, and says where the rooms are. Rays are keyed by stable patch ids and cells lie on a fixed grid, so a
/// moved chair changes what it is seen by, and nothing else.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "baker/patches/patch.h"
#include "baker/trace/tracer.h"
#include "baker/unwrap/atlas.h"

namespace luxel {

/// Pieces of surface of one chart that face about the same way, each within a cube of the grid: never both sides of a
/// wall. In the order of their smallest stable ids, so cells keep their order when others come and go.
struct SightCells {
    std::vector<std::uint32_t> cell_of;             ///< per patch number
    std::vector<std::vector<PatchNumber>> patches;  ///< per cell, ascending, not empty
    std::vector<Vec3d> middle;                      ///< per cell: of its cube, m
    [[nodiscard]] std::size_t count() const { return patches.size(); }
};

/// `edge_m` > 0: of the cubes, a power of two, so that halvings of space never cut one.
SightCells find_sight_cells(const PatchSet& patches, double edge_m);

/// Symmetric; what a node sees of itself is not in it.
struct SightGraph {
    struct Link {
        std::uint32_t other;
        std::uint32_t rays;  ///< > 0, both ways together
    };
    std::vector<std::size_t> row_begin{
        0};  ///< links of node n: [row_begin[n], row_begin[n + 1]), every other node once
    std::vector<Link> links;
    std::vector<std::uint32_t> patches;  ///< per node: how many it stands for, > 0
    [[nodiscard]] std::size_t count() const { return patches.size(); }
    [[nodiscard]] std::span<const Link> links_of(std::size_t node) const {
        return {links.data() + row_begin[node], links.data() + row_begin[node + 1]};
    }
};

/// Nodes are the cells. Every patch sends `rays_per_patch` rays from its visible area, a pure function of geometry and
/// its stable id. Threads: uses them all; the result does not depend on their number. Memory: 8 bytes per link, of
/// which there are at most two per ray; while it is made, 36 bytes per ray. Rays of all patches together are below
/// 2^32.
SightGraph trace_sight(const Scene& scene, const Atlas& atlas, const PatchSet& patches, const Tracer& tracer,
                       const SightCells& cells, std::uint32_t rays_per_patch);

/// The same graph with nodes joined: node n becomes part of group[n] < group_count; no group is empty.
SightGraph join_nodes(const SightGraph& graph, std::span<const std::uint32_t> group, std::size_t group_count);

}  // namespace luxel
