/// One object as the unwrapper sees it: welded vertices of Scene::shape_positions, so that copies of a mesh are the same
/// bits wherever they stand, and far objects keep their precision.
/// Lengths in metres, double. Threads: all functions are pure. Errors: none.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "baker/scene/scene.h"

namespace luxel {

struct ObjectMesh {
    std::vector<Vec3d> positions;  ///< one per distinct position; frame of the object
    /// Triangle i of the object, in the winding of the source file (mirrored objects: corners 1 and 2 swapped back).
    std::vector<std::array<std::uint32_t, 3>> triangles;

    [[nodiscard]] Vec3d area_vector(std::uint32_t triangle) const {
        const auto& corners = triangles[triangle];
        const Vec3d& a = positions[corners[0]];
        return (positions[corners[1]] - a).cross(positions[corners[2]] - a);
    }
    [[nodiscard]] double area_m2(std::uint32_t triangle) const { return 0.5 * area_vector(triangle).length(); }
};

/// Corner of the ObjectMesh that corner k of the scene's triangle is.
inline std::size_t mesh_corner(const Object& object, std::size_t k) { return object.mirrored && k ? 3 - k : k; }

ObjectMesh object_mesh(const Scene& scene, const Object& object);

/// Do the two objects show the same mesh in the same size (rigid motion or mirror image)? Then their ObjectMesh is equal.
bool same_shape(const Scene& scene, const Object& a, const Object& b);

/// Sets of triangles (indexes into mesh.triangles) that hang together through shared edges of `subset`, each ascending,
/// ordered by their lowest triangle.
std::vector<std::vector<std::uint32_t>> edge_connected_sets(const ObjectMesh& mesh,
                                                            const std::vector<std::uint32_t>& subset);

/// An edge of a subset of triangles; equal (low, high) means shared.
struct MeshEdge {
    std::uint32_t low = 0, high = 0;  ///< vertices
    std::uint32_t index = 0;          ///< position of the triangle in the subset
    std::uint32_t corner = 0;         ///< edge from this corner to the next
    bool operator<(const MeshEdge& other) const {
        if (low != other.low) return low < other.low;
        if (high != other.high) return high < other.high;
        return index < other.index;
    }
};
/// All edges of the subset, sorted.
std::vector<MeshEdge> sorted_edges(const ObjectMesh& mesh, const std::vector<std::uint32_t>& subset);

/// Disjoint sets with path halving; the root of a set is its lowest member.
class DisjointSets {
  public:
    explicit DisjointSets(std::size_t count);
    std::uint32_t root(std::uint32_t member);
    void join(std::uint32_t a, std::uint32_t b);

  private:
    std::vector<std::uint32_t> parent_;
};

}  // namespace luxel
