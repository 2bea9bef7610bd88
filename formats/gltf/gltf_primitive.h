/// One primitive of a mesh as arrays, whatever way it is stored (plain, sparse, meshopt, Draco).
///
/// Errors   Error{bad_input} naming mesh and primitive: attribute lengths that differ, an index out of range, an index
///          list that does not fit the mode is cut as the specification says (an incomplete triangle is dropped).
/// Threads  pure functions.
/// Source   glTF 2.0 specification, section 3.7.2; KHR_draco_mesh_compression.
#pragma once
#include <array>
#include <map>
#include <string>
#include <vector>

#include "formats/gltf/gltf_accessor.h"

namespace luxel {

/// Values are glTF's.
enum class PrimitiveMode : int {
    points = 0, lines = 1, line_loop = 2, line_strip = 3, triangles = 4, triangle_strip = 5, triangle_fan = 6
};

struct PrimitiveArrays {
    PrimitiveMode mode = PrimitiveMode::triangles;
    std::uint64_t vertex_count = 0;  ///< of POSITION; every attribute has as many elements
    std::map<std::string, AccessorBytes> attributes;  ///< by semantic: POSITION, NORMAL, TEXCOORD_0, JOINTS_0, _CUSTOM ...
    bool indexed = false;
    std::vector<std::uint32_t> indices;  ///< as the mode wants them, below vertex_count; 0, 1, 2 ... if not indexed
};

/// The mode alone, without reading arrays.
PrimitiveMode primitive_mode(const GltfDocument& document, std::int64_t mesh, std::int64_t primitive);

/// All attributes and indices of a primitive. Draco streams are decoded into the accessors' component types;
/// a Draco stream always gives triangles, so the mode of a Draco strip becomes `triangles`.
/// `wanted` limits reading to these semantics (empty: all); POSITION is always read.
PrimitiveArrays read_primitive(const GltfDocument& document, std::int64_t mesh, std::int64_t primitive,
                               const std::vector<std::string>& wanted = {});

/// Three indices per triangle, counter-clockwise fronts; restart values do not exist in glTF. Empty for points and
/// lines. Triangle t of this list is what Scene::source_triangle and PrimitiveRecord count.
std::vector<std::uint32_t> triangle_list(PrimitiveMode mode, const std::vector<std::uint32_t>& indices);

/// `hall.glb: mesh "Stairs" primitive 2`.
std::string primitive_name(const GltfDocument& document, std::int64_t mesh, std::int64_t primitive);

}  // namespace luxel
