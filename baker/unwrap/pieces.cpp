#include "baker/unwrap/pieces.h"

#include <algorithm>

namespace luxel {
namespace {

using TriangleList = std::vector<std::uint32_t>;

/// Halves at the median of the triangles' centroids; the triangle's number breaks ties.
void bisect(const std::vector<Vec3d>& centroids, TriangleList part, std::size_t limit, std::vector<TriangleList>& out) {
    if (part.size() <= limit) {
        std::sort(part.begin(), part.end());
        out.push_back(std::move(part));
        return;
    }
    Vec3d low = centroids[part[0]], high = low;
    for (const std::uint32_t t : part)
        for (int axis = 0; axis < 3; ++axis) {
            low[axis] = std::min(low[axis], centroids[t][axis]);
            high[axis] = std::max(high[axis], centroids[t][axis]);
        }
    const Vec3d extent = high - low;
    const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
    const auto middle = part.begin() + static_cast<std::ptrdiff_t>(part.size() / 2);
    std::nth_element(part.begin(), middle, part.end(), [&](std::uint32_t a, std::uint32_t b) {
        const double ca = centroids[a][axis], cb = centroids[b][axis];
        return ca != cb ? ca < cb : a < b;
    });
    bisect(centroids, TriangleList(part.begin(), middle), limit, out);
    bisect(centroids, TriangleList(middle, part.end()), limit, out);
}

std::vector<TriangleList> vertex_connected_sets(const ObjectMesh& mesh) {
    DisjointSets sets(mesh.positions.size());
    for (const auto& corners : mesh.triangles) {
        sets.join(corners[0], corners[1]);
        sets.join(corners[0], corners[2]);
    }
    std::vector<TriangleList> result;
    std::vector<std::uint32_t> number(mesh.positions.size(), none);
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        const std::uint32_t root = sets.root(mesh.triangles[t][0]);
        if (number[root] == none) {
            number[root] = static_cast<std::uint32_t>(result.size());
            result.emplace_back();
        }
        result[number[root]].push_back(t);
    }
    return result;
}

}  // namespace

std::vector<std::vector<std::uint32_t>> cut_pieces(const ObjectMesh& mesh, std::size_t limit) {
    std::vector<Vec3d> centroids(mesh.triangles.size());
    for (std::size_t t = 0; t < centroids.size(); ++t) {
        const auto& corners = mesh.triangles[t];
        centroids[t] = mesh.positions[corners[0]] + mesh.positions[corners[1]] + mesh.positions[corners[2]];
    }
    std::vector<TriangleList> pieces;
    TriangleList collected;
    const auto flush = [&] {
        if (collected.empty()) return;
        std::sort(collected.begin(), collected.end());
        pieces.push_back(std::move(collected));
        collected.clear();
    };
    for (TriangleList& part : vertex_connected_sets(mesh)) {
        if (part.size() > limit) {
            bisect(centroids, std::move(part), limit, pieces);
            continue;
        }
        if (collected.size() + part.size() > limit) flush();
        collected.insert(collected.end(), part.begin(), part.end());
    }
    flush();
    return pieces;
}

}  // namespace luxel
