#include "baker/unwrap/object_mesh.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace luxel {
namespace {

bool less_position(const Vec3f& a, const Vec3f& b) {
    if (a.x != b.x) return a.x < b.x;
    if (a.y != b.y) return a.y < b.y;
    return a.z < b.z;
}

}  // namespace

ObjectMesh object_mesh(const Scene& scene, const Object& object) {
    ObjectMesh mesh;
    const Vec3f* positions = scene.shape_positions.data() + object.first_vertex;
    std::vector<std::uint32_t> order(object.vertex_count), welded(object.vertex_count);
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
        if (less_position(positions[a], positions[b])) return true;
        if (less_position(positions[b], positions[a])) return false;
        return a < b;
    });
    // Each group of equal positions is named by its lowest vertex; names are then made dense in vertex order.
    std::vector<std::uint32_t> first(object.vertex_count);
    for (std::size_t i = 0; i < order.size(); ++i) {
        const bool same = i && !less_position(positions[order[i - 1]], positions[order[i]]);
        first[order[i]] = same ? first[order[i - 1]] : order[i];
    }
    const Vec3d origin = object.vertex_count ? to_double(positions[0]) : Vec3d(0, 0, 0);
    for (std::uint32_t v = 0; v < object.vertex_count; ++v) {
        if (first[v] != v) {
            welded[v] = welded[first[v]];
            continue;
        }
        welded[v] = static_cast<std::uint32_t>(mesh.positions.size());
        mesh.positions.push_back(to_double(positions[v]) - origin);
    }
    mesh.triangles.resize(object.triangle_count);
    for (std::uint32_t i = 0; i < object.triangle_count; ++i)
        for (std::size_t k = 0; k < 3; ++k)
            mesh.triangles[i][k] =
                welded[scene.triangles[object.first_triangle + i][mesh_corner(object, k)] - object.first_vertex];
    return mesh;
}

bool same_shape(const Scene& scene, const Object& a, const Object& b) {
    if (a.content_hash != b.content_hash || a.metric != b.metric || a.triangle_count != b.triangle_count) return false;
    // Rounding may have cost one copy a triangle that another kept.
    const auto kept = scene.source_triangle.begin();
    return std::equal(kept + a.first_triangle, kept + a.first_triangle + a.triangle_count, kept + b.first_triangle);
}

std::vector<MeshEdge> sorted_edges(const ObjectMesh& mesh, const std::vector<std::uint32_t>& subset) {
    std::vector<MeshEdge> edges;
    edges.reserve(subset.size() * 3);
    for (std::uint32_t i = 0; i < subset.size(); ++i)
        for (std::uint32_t k = 0; k < 3; ++k) {
            const std::uint32_t a = mesh.triangles[subset[i]][k], b = mesh.triangles[subset[i]][(k + 1) % 3];
            edges.push_back({std::min(a, b), std::max(a, b), i, k});
        }
    std::sort(edges.begin(), edges.end());
    return edges;
}

std::vector<std::vector<std::uint32_t>> edge_connected_sets(const ObjectMesh& mesh,
                                                            const std::vector<std::uint32_t>& subset) {
    const std::vector<MeshEdge> edges = sorted_edges(mesh, subset);
    DisjointSets sets(subset.size());
    for (std::size_t e = 1; e < edges.size(); ++e)
        if (edges[e].low == edges[e - 1].low && edges[e].high == edges[e - 1].high)
            sets.join(edges[e].index, edges[e - 1].index);
    std::vector<std::vector<std::uint32_t>> result;
    std::vector<std::uint32_t> number(subset.size(), none);
    for (std::uint32_t i = 0; i < subset.size(); ++i) {
        const std::uint32_t root = sets.root(i);
        if (number[root] == none) {
            number[root] = static_cast<std::uint32_t>(result.size());
            result.emplace_back();
        }
        result[number[root]].push_back(subset[i]);
    }
    return result;
}

DisjointSets::DisjointSets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0u); }

std::uint32_t DisjointSets::root(std::uint32_t member) {
    while (parent_[member] != member) {
        parent_[member] = parent_[parent_[member]];
        member = parent_[member];
    }
    return member;
}

void DisjointSets::join(std::uint32_t a, std::uint32_t b) {
    const std::uint32_t ra = root(a), rb = root(b);
    if (ra < rb)
        parent_[rb] = ra;
    else
        parent_[ra] = rb;
}

}  // namespace luxel
