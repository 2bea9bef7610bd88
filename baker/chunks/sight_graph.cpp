#include "baker/chunks/sight_graph.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "baker/core/parallel.h"
#include "baker/core/sampling.h"
#include "baker/core/sobol.h"
#include "baker/patches/patch_sampler.h"
#include "baker/core/ray_offset.h"
#include "baker/trace/surface_map.h"

namespace luxel {
namespace {

constexpr std::uint64_t purpose = 0x7369676874;  // separates these points from those of the evidence

/// Chart, side, axis that the normal is nearest to, cube of the grid.
using CellKey = std::array<std::int64_t, 5>;

std::int64_t facing(const Vec3f& normal) {
    const Vec3d n = to_double(normal), size{std::fabs(n.x), std::fabs(n.y), std::fabs(n.z)};
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    return 2 * axis + (n[axis] < 0);
}

CellKey key_of(const Patch& patch, double edge_m) {
    const auto cube = [&](int axis) {
        return static_cast<std::int64_t>(std::floor(static_cast<double>(patch.center[axis]) / edge_m));
    };
    return {2 * std::int64_t{patch.chart} + patch.is_back, facing(patch.normal), cube(0), cube(1), cube(2)};
}

/// Cells that the rays of one cell landed in, ascending, as often as they did.
std::vector<std::uint32_t> cast(const Scene& scene, const Atlas& atlas, const PatchSet& patches, const Tracer& tracer,
                                const SightCells& cells, std::size_t cell, std::uint32_t rays_per_patch) {
    std::vector<TraceRay> rays(rays_per_patch);
    std::vector<TraceHit> hits(rays_per_patch);
    std::vector<std::uint32_t> met;
    for (const PatchNumber patch : cells.patches[cell]) {
        const PatchSampler sampler(scene, atlas, patches, patch);
        const SobolSequence sequence(mix(patches.patches[patch].id, purpose));
        for (std::uint32_t k = 0; k < rays_per_patch; ++k) {
            const auto u = sequence.point(k);
            const SurfacePoint at = sampler.point(u[0], u[1]);
            rays[k] = {offset_origin(at.position, at.normal, scene.corner_extent(at.triangle)),
                       Frame(at.normal).to_world(cosine_direction(u[2], u[3])), at.triangle};
        }
        tracer.first_hits(rays, hits);
        for (const TraceHit& hit : hits) {
            const Landing at = landing(scene, atlas, patches, hit);
            if (at.end == RayEnd::patch) met.push_back(cells.cell_of[at.patch]);
        }
    }
    std::sort(met.begin(), met.end());
    return met;
}

/// Rows of one-way counts become rows of both ways together.
SightGraph both_ways(const std::vector<std::vector<std::uint32_t>>& met, SightGraph graph) {
    const std::size_t count = met.size();
    std::vector<std::size_t> row_size(count, 0);
    const auto runs = [&](std::size_t node, const auto& body) {
        for (std::size_t k = 0, end; k < met[node].size(); k = end) {
            for (end = k + 1; end < met[node].size() && met[node][end] == met[node][k];) ++end;
            body(met[node][k], static_cast<std::uint32_t>(end - k));
        }
    };
    for (std::size_t node = 0; node < count; ++node)
        runs(node, [&](std::uint32_t other, std::uint32_t) { ++row_size[node], ++row_size[other]; });
    std::vector<std::vector<SightGraph::Link>> rows(count);
    for (std::size_t node = 0; node < count; ++node) rows[node].reserve(row_size[node]);
    for (std::size_t node = 0; node < count; ++node)
        runs(node, [&](std::uint32_t other, std::uint32_t rays) {
            if (other == node) return;
            rows[node].push_back({other, rays});
            rows[other].push_back({static_cast<std::uint32_t>(node), rays});
        });
    for (auto& row : rows) {
        std::sort(row.begin(), row.end(), [](const auto& a, const auto& b) { return a.other < b.other; });
        for (const SightGraph::Link& link : row) {
            if (graph.links.size() > graph.row_begin.back() && graph.links.back().other == link.other)
                graph.links.back().rays += link.rays;
            else
                graph.links.push_back(link);
        }
        graph.row_begin.push_back(graph.links.size());
        row = {};
    }
    return graph;
}

}  // namespace

SightCells find_sight_cells(const PatchSet& patches, double edge_m) {
    std::vector<CellKey> keys;
    keys.reserve(patches.count());
    for (const Patch& patch : patches.patches) keys.push_back(key_of(patch, edge_m));
    std::vector<PatchNumber> order(patches.count());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(),
              [&](PatchNumber a, PatchNumber b) { return keys[a] != keys[b] ? keys[a] < keys[b] : a < b; });
    std::vector<std::vector<PatchNumber>> found;
    for (std::size_t k = 0; k < order.size(); ++k) {
        if (k == 0 || keys[order[k]] != keys[order[k - 1]]) found.emplace_back();
        found.back().push_back(order[k]);
    }
    std::vector<std::pair<PatchId, std::size_t>> named;
    for (std::size_t c = 0; c < found.size(); ++c) {
        PatchId least = ~PatchId{0};
        for (const PatchNumber p : found[c]) least = std::min(least, patches.patches[p].id);
        named.emplace_back(least, c);
    }
    std::sort(named.begin(), named.end());
    SightCells cells;
    cells.cell_of.resize(patches.count());
    for (const auto& [id, c] : named) {
        const CellKey& key = keys[found[c].front()];
        const auto middle = [&](std::size_t k) { return (static_cast<double>(key[k]) + 0.5) * edge_m; };
        for (const PatchNumber p : found[c]) cells.cell_of[p] = static_cast<std::uint32_t>(cells.count());
        cells.patches.push_back(std::move(found[c]));
        cells.middle.push_back({middle(2), middle(3), middle(4)});
    }
    return cells;
}

SightGraph trace_sight(const Scene& scene, const Atlas& atlas, const PatchSet& patches, const Tracer& tracer,
                       const SightCells& cells, std::uint32_t rays_per_patch) {
    std::vector<std::vector<std::uint32_t>> met(cells.count());
    parallel_for(cells.count(), 4, [&](std::size_t cell) {
        met[cell] = cast(scene, atlas, patches, tracer, cells, cell, rays_per_patch);
    });
    SightGraph graph;
    for (const auto& members : cells.patches) graph.patches.push_back(static_cast<std::uint32_t>(members.size()));
    return both_ways(met, std::move(graph));
}

SightGraph join_nodes(const SightGraph& graph, std::span<const std::uint32_t> group, std::size_t group_count) {
    std::vector<std::vector<std::uint32_t>> members(group_count);
    for (std::size_t node = 0; node < graph.count(); ++node)
        members[group[node]].push_back(static_cast<std::uint32_t>(node));
    SightGraph joined;
    std::vector<std::uint32_t> rays(group_count, 0);
    std::vector<std::uint32_t> met;
    for (std::size_t g = 0; g < group_count; ++g) {
        joined.patches.push_back(0);
        met.clear();
        for (const std::uint32_t node : members[g]) {
            joined.patches.back() += graph.patches[node];
            for (const SightGraph::Link& link : graph.links_of(node)) {
                const std::uint32_t other = group[link.other];
                if (!rays[other]) met.push_back(other);
                rays[other] += link.rays;
            }
        }
        for (const std::uint32_t other : met) {
            if (other != g) joined.links.push_back({other, rays[other]});
            rays[other] = 0;
        }
        joined.row_begin.push_back(joined.links.size());
    }
    return joined;
}

}  // namespace luxel
