/// Gives meshes their lightmap layout: copies per node, splits vertices and primitives, clones materials.
/// Private to the gltf_out files.
#pragma once
#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "formats/gltf/gltf_out.h"
#include "formats/gltf/gltf_out_arrays.h"
#include "formats/gltf/gltf_out_material.h"
#include "formats/gltf/gltf_out_nodes.h"
#include "formats/gltf/gltf_out_split.h"
#include "formats/gltf/gltf_primitive.h"

namespace luxel {

/// One primitive of the input with everything a copy of it is gathered from.
struct SourcePrimitive {
    std::int64_t primitive = 0;  ///< in the mesh of the file
    std::string where;
    PrimitiveArrays arrays;
    std::vector<std::uint32_t> triangles;                       ///< 3 vertices each
    std::vector<std::map<std::string, AccessorBytes>> targets;  ///< morph targets by semantic
};

/// A mesh with a layout, still without materials for a place.
struct LaidOutMesh {
    /// A primitive that a part of the layout became, and what its materials are made of.
    struct Part {
        std::size_t primitive = 0;  ///< in `mesh`
        std::int64_t source = 0;    ///< primitive of the input's mesh
        std::uint32_t page = 0;
        std::uint64_t moved_uv_set = 0;
    };
    std::int64_t source = 0;  ///< mesh of the input
    nlohmann::json mesh;
    std::vector<Part> parts;

    [[nodiscard]] std::set<std::uint32_t> pages() const;
};

class MeshRewriter {
  public:
    MeshRewriter(OutputModel& model, LightmapMaterials& materials, std::size_t page_count)
        : model_(model), materials_(materials), arrays_(model), page_count_(page_count), has_old_layout_(meshes_with_node_lightmap(model.document)) {}

    /// Reads the primitives of a mesh that `record` has triangles of, in its order.
    std::vector<SourcePrimitive> read_mesh(std::int64_t mesh, const MeshRecord& record) const;

    /// Adds the mesh's arrays with a layout. Primitives without any placed triangle stay as they are.
    LaidOutMesh lay_out(std::int64_t mesh, const std::vector<SourcePrimitive>& sources, const MeshLayout& layout);
    /// The mesh with its materials for one place of the layout.
    nlohmann::json at_place(const LaidOutMesh& laid_out, const LayoutPlace& place);

    /// The part of the mesh on one of its pages, for nodes that name the lightmap. Primitives without a page go with the first.
    nlohmann::json on_page(const LaidOutMesh& laid_out, std::uint32_t page);

    /// Where all arrays of this model go.
    ArrayStore& arrays() { return arrays_; }

  private:
    nlohmann::json make_part(const nlohmann::json& item, const SourcePrimitive& source, const PagePart& part, std::uint64_t moved_set);
    std::uint64_t choose_moved_set(std::int64_t mesh, const nlohmann::json& item) const;
    template <class Material>
    void set_materials(const LaidOutMesh& laid_out, const LaidOutMesh::Part& part, nlohmann::json& primitive, const Material& material_of);
    void add_lightmap_uv(const nlohmann::json& item, const std::string& where, const PagePart& part,
                         nlohmann::json& attributes);
    nlohmann::json gather_attributes(const nlohmann::json& accessors_by_name,
                                     const std::map<std::string, AccessorBytes>& arrays, const PagePart& part,
                                     std::uint64_t moved_set);

    OutputModel& model_;
    LightmapMaterials& materials_;
    ArrayStore arrays_;
    std::size_t page_count_;
    std::vector<bool> has_old_layout_;  ///< per mesh of the input: TEXCOORD_1 is of an earlier bake
};

}  // namespace luxel
