#include "formats/gltf/gltf_primitive.h"

#include <algorithm>
#include <numeric>

#include "formats/gltf/gltf_compression.h"
#include "formats/gltf/gltf_json.h"

namespace luxel {

using nlohmann::json;

namespace {

/// Not indexed, the vertices themselves are listed: bounded by what the file holds, but never by more than 32 bits.
constexpr std::uint64_t most_vertices = 0xfffffffe;

const json& primitive_item(const GltfDocument& document, std::int64_t mesh, std::int64_t primitive) {
    const json& item = gltf_item(document.json, "meshes", mesh, document.name);
    const std::string where = document.name + ": " + gltf_name(item, "mesh", mesh);
    return gltf_item(item, "primitives", primitive, where);
}

bool is_wanted(const std::string& semantic, const std::vector<std::string>& wanted) {
    return wanted.empty() || semantic == "POSITION" || std::ranges::find(wanted, semantic) != wanted.end();
}

void read_draco_part(const GltfDocument& document, const json& item, const json& draco,
                     const std::vector<std::string>& wanted, PrimitiveArrays& out, const std::string& where) {
    std::vector<DracoAttribute> inside;
    const json& attributes = json_object(item, "attributes", where);
    for (const auto& [semantic, id] : json_object(draco, "attributes", where).items()) {
        if (!attributes.contains(semantic) || !is_wanted(semantic, wanted)) continue;
        const auto accessor = static_cast<std::int64_t>(json_value_size(attributes[semantic], semantic, where));
        const std::uint64_t unique_id = json_value_size(id, "Draco id of " + semantic, where);
        inside.push_back({semantic, static_cast<std::uint32_t>(std::min<std::uint64_t>(unique_id, 0xffffffffu)),
                          describe_accessor(document, accessor, where + ": " + semantic)});
    }
    const auto view = static_cast<std::int64_t>(json_size_required(draco, "bufferView", where));
    DracoMesh mesh = decode_draco(document.view(view, where), inside, where);
    out.attributes.merge(mesh.attributes);
    out.indices = std::move(mesh.indices);
    out.indexed = true;
    out.mode = PrimitiveMode::triangles;
}

void check_lengths(PrimitiveArrays& arrays, const std::string& where) {
    const auto position = arrays.attributes.find("POSITION");
    if (position == arrays.attributes.end()) return;
    arrays.vertex_count = position->second.count;
    if (arrays.vertex_count > most_vertices)
        bad_gltf(where, std::to_string(arrays.vertex_count) + " vertices are more than 32-bit indices can name");
    for (const auto& [semantic, elements] : arrays.attributes)
        if (elements.count != arrays.vertex_count)
            bad_gltf(where, semantic + " has " + std::to_string(elements.count) + " elements, POSITION has " +
                                std::to_string(arrays.vertex_count));
}

}  // namespace

std::string primitive_name(const GltfDocument& document, std::int64_t mesh, std::int64_t primitive) {
    const json& item = gltf_item(document.json, "meshes", mesh, document.name);
    return document.name + ": " + gltf_name(item, "mesh", mesh) + " primitive " + std::to_string(primitive);
}

PrimitiveMode primitive_mode(const GltfDocument& document, std::int64_t mesh, std::int64_t primitive) {
    const json& item = primitive_item(document, mesh, primitive);
    const std::string where = primitive_name(document, mesh, primitive);
    const std::uint64_t mode = json_size(item, "mode", 4, where);
    if (mode > 6) bad_gltf(where, "mode: expected 0 to 6, found " + std::to_string(mode));
    return static_cast<PrimitiveMode>(mode);
}

PrimitiveArrays read_primitive(const GltfDocument& document, std::int64_t mesh, std::int64_t primitive,
                               const std::vector<std::string>& wanted) {
    const json& item = primitive_item(document, mesh, primitive);
    const std::string where = primitive_name(document, mesh, primitive);
    PrimitiveArrays out;
    out.mode = primitive_mode(document, mesh, primitive);
    const json* draco = json_extension(item, "KHR_draco_mesh_compression", where);
    if (draco) read_draco_part(document, item, *draco, wanted, out, where);
    for (const auto& [semantic, accessor] : json_object(item, "attributes", where).items()) {
        const std::string here = where + ": " + semantic;
        if (!is_wanted(semantic, wanted) || out.attributes.contains(semantic)) continue;
        const auto index = static_cast<std::int64_t>(json_value_size(accessor, "accessor", here));
        out.attributes.emplace(semantic, read_elements(document, index, here));
    }
    check_lengths(out, where);
    if (!draco && item.contains("indices")) {
        const auto accessor = static_cast<std::int64_t>(json_size_required(item, "indices", where));
        out.indices = to_indices(read_elements(document, accessor, where + ": indices"), where);
        out.indexed = true;
    } else if (!draco) {
        out.indices.resize(out.vertex_count);
        std::iota(out.indices.begin(), out.indices.end(), 0u);
    }
    for (std::size_t i = 0; i < out.indices.size(); ++i)
        if (out.indices[i] >= out.vertex_count)
            bad_gltf(where, "index " + std::to_string(out.indices[i]) + " at place " + std::to_string(i) +
                                ", but there are only " + std::to_string(out.vertex_count) + " vertices",
                     "the file is damaged; export it again");
    return out;
}

std::vector<std::uint32_t> triangle_list(PrimitiveMode mode, const std::vector<std::uint32_t>& indices) {
    std::vector<std::uint32_t> out;
    const std::size_t count = indices.size();
    if (mode == PrimitiveMode::triangles) {
        out.assign(indices.begin(), indices.begin() + static_cast<std::ptrdiff_t>(count / 3 * 3));
    } else if (mode == PrimitiveMode::triangle_strip && count >= 3) {
        // Source: glTF 2.0, section 3.7.2.1: every second triangle swaps its last two corners to keep the winding.
        out.reserve((count - 2) * 3);
        for (std::size_t i = 0; i + 2 < count; ++i)
            out.insert(out.end(), {indices[i], indices[i + 1 + i % 2], indices[i + 2 - i % 2]});
    } else if (mode == PrimitiveMode::triangle_fan && count >= 3) {
        out.reserve((count - 2) * 3);
        for (std::size_t i = 1; i + 1 < count; ++i) out.insert(out.end(), {indices[i], indices[i + 1], indices[0]});
    }
    return out;
}

}  // namespace luxel
