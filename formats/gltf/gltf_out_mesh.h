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

class MeshRewriter {
  public:
    MeshRewriter(OutputModel& model, LightmapMaterials& materials, std::size_t page_count)
        : model_(model), materials_(materials), arrays_(model), page_count_(page_count) {}

    /// Reads the primitives of a mesh that `record` has triangles of, in its order.
    std::vector<SourcePrimitive> read_mesh(std::int64_t mesh, const MeshRecord& record) const;

    /// The mesh with the layout of one node. Primitives without a layout, or without any placed triangle, stay.
    nlohmann::json rewrite(std::int64_t mesh, const std::vector<SourcePrimitive>& sources,
                           const InstanceLayout& layout);

  private:
    void append_parts(const nlohmann::json& item, const SourcePrimitive& source, const PrimitiveLayout& layout,
                      nlohmann::json& out);
    nlohmann::json make_part(const nlohmann::json& item, const SourcePrimitive& source, const PagePart& part);
    std::uint64_t choose_moved_set(const nlohmann::json& item) const;
    void add_lightmap_uv(const nlohmann::json& item, const std::string& where, const PagePart& part,
                         nlohmann::json& attributes);
    nlohmann::json gather_attributes(const nlohmann::json& accessors_by_name,
                                     const std::map<std::string, AccessorBytes>& arrays, const PagePart& part,
                                     std::uint64_t moved_set);

    OutputModel& model_;
    LightmapMaterials& materials_;
    ArrayStore arrays_;
    std::size_t page_count_;
};

}  // namespace luxel
