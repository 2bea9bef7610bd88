#include "baker/unwrap/planar_charts.h"

#include <algorithm>

namespace luxel {
namespace {

/// Regions grown over shared edges from the lowest triangle, as long as normals stay near the first one's.
std::vector<std::vector<std::uint32_t>> grow_regions(const ObjectMesh& mesh,
                                                     const std::vector<std::uint32_t>& triangles, double min_cosine) {
    const std::vector<MeshEdge> edges = sorted_edges(mesh, triangles);
    // Neighbour across each edge, only where exactly two triangles meet.
    std::vector<std::array<std::uint32_t, 3>> neighbour(triangles.size(), {none, none, none});
    for (std::size_t begin = 0; begin < edges.size();) {
        std::size_t end = begin + 1;
        while (end < edges.size() && edges[end].low == edges[begin].low && edges[end].high == edges[begin].high) ++end;
        if (end - begin == 2) {
            neighbour[edges[begin].index][edges[begin].corner] = edges[begin + 1].index;
            neighbour[edges[begin + 1].index][edges[begin + 1].corner] = edges[begin].index;
        }
        begin = end;
    }
    std::vector<bool> taken(triangles.size(), false);
    std::vector<std::vector<std::uint32_t>> regions;
    for (std::uint32_t seed = 0; seed < triangles.size(); ++seed) {
        if (taken[seed]) continue;
        const Vec3d normal = mesh.area_vector(triangles[seed]).normalized();
        std::vector<std::uint32_t> queue{seed};
        taken[seed] = true;
        for (std::size_t at = 0; at < queue.size(); ++at)
            for (const std::uint32_t next : neighbour[queue[at]]) {
                if (next == none || taken[next]) continue;
                if (mesh.area_vector(triangles[next]).normalized().dot(normal) < min_cosine) continue;
                taken[next] = true;
                queue.push_back(next);
            }
        auto& region = regions.emplace_back();
        for (const std::uint32_t index : queue) region.push_back(triangles[index]);
        std::sort(region.begin(), region.end());
    }
    return regions;
}

FlatChart flat_chart(const ObjectMesh& mesh, std::vector<std::uint32_t> triangles) {
    FlatChart chart = project_chart(mesh, std::move(triangles));
    restore_scale(mesh, chart);
    orient(chart);
    return chart;
}

}  // namespace

std::vector<FlatChart> planar_charts(const ObjectMesh& mesh, const std::vector<std::uint32_t>& triangles,
                                     double samples_per_metre) {
    std::vector<FlatChart> charts;
    for (auto& region : grow_regions(mesh, triangles, 0.9)) {
        FlatChart wide = flat_chart(mesh, region);
        if (region.size() == 1 || is_valid(mesh, wide, samples_per_metre)) {
            charts.push_back(std::move(wide));
            continue;
        }
        for (auto& plane : grow_regions(mesh, region, 0.9999)) {
            FlatChart flat = flat_chart(mesh, plane);
            if (plane.size() == 1 || is_valid(mesh, flat, samples_per_metre)) {
                charts.push_back(std::move(flat));
                continue;
            }
            for (const std::uint32_t t : plane) charts.push_back(flat_chart(mesh, {t}));
        }
    }
    return charts;
}

}  // namespace luxel
