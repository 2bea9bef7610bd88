#include "formats/gltf/gltf_in.h"

#include <charconv>
#include <set>

#include "formats/gltf/gltf_json.h"
#include "formats/gltf/gltf_materials.h"
#include "formats/gltf/gltf_nodes.h"
#include "formats/gltf/gltf_primitive.h"
#include "formats/gltf/gltf_sky.h"
#include "formats/gltf/node_settings.h"

namespace luxel {

using nlohmann::json;

namespace {

/// The vectors of one attribute; empty if the primitive has none.
template <class Vector>
std::vector<Vector> read_vectors(const PrimitiveArrays& arrays, const char* semantic, const char* type,
                                 const std::string& where) {
    const auto found = arrays.attributes.find(semantic);
    if (found == arrays.attributes.end()) return {};
    if (found->second.type != type)
        bad_gltf(where, std::string(semantic) + ": expected " + type + ", found " + found->second.type);
    const std::vector<float> numbers = to_floats(found->second);
    std::vector<Vector> out(found->second.count);
    constexpr std::size_t width = sizeof(Vector) / sizeof(float);
    for (std::size_t i = 0; i < out.size(); ++i)
        for (std::size_t c = 0; c < width; ++c) out[i][static_cast<int>(c)] = numbers[i * width + c];
    return out;
}

/// COLOR_0, empty if the primitive has none or nothing that can be read as colours: then a warning.
std::vector<std::array<float, 4>> read_colors(PrimitiveArrays& arrays, const std::string& where, std::vector<Warning>& warnings) {
    const auto found = arrays.attributes.find("COLOR_0");
    if (found == arrays.attributes.end()) return {};
    AccessorBytes& elements = found->second;
    const bool is_float = elements.component == ComponentType::f32;
    const bool is_known = is_float || elements.component == ComponentType::u8 || elements.component == ComponentType::u16;
    if ((elements.type != "VEC3" && elements.type != "VEC4") || !is_known) {
        warnings.push_back({"vertex-colours", where, "COLOR_0: expected VEC3 or VEC4 of floats or normalized unsigned bytes or shorts, found " +
                                                         elements.type + " of type " + std::to_string(static_cast<int>(elements.component)) + ": ignored"});
        return {};
    }
    if (!is_float && !elements.normalized)
        warnings.push_back({"vertex-colours", where, "COLOR_0: its integers are not marked as normalized: they are taken as if they were"});
    elements.normalized = true;
    const std::vector<float> numbers = to_floats(elements);
    std::vector<std::array<float, 4>> colors(elements.count, {1, 1, 1, 1});
    for (std::size_t i = 0; i < colors.size(); ++i)
        for (std::size_t c = 0; c < elements.components; ++c) colors[i][c] = numbers[i * elements.components + c];
    return colors;
}

bool has_triangles(PrimitiveMode mode) {
    return mode == PrimitiveMode::triangles || mode == PrimitiveMode::triangle_strip || mode == PrimitiveMode::triangle_fan;
}

class MeshReader {
  public:
    MeshReader(const GltfDocument& document, bool vertex_colors, SceneRecord& record)
        : document_(document), record_(record), wanted_{"NORMAL", "TEXCOORD_0", "TEXCOORD_1"} {
        if (vertex_colors) wanted_.emplace_back("COLOR_0");
    }

    void read(std::int64_t mesh) {
        const json& item = gltf_item(document_.json, "meshes", mesh, document_.name);
        const std::size_t count = json_array(item, "primitives", document_.name + ": " + gltf_name(item, "mesh", mesh)).size();
        for (std::size_t p = 0; p < count; ++p) read_one(mesh, static_cast<std::int64_t>(p));
    }

  private:
    void warn(const char* code, const std::string& where, const std::string& text) {
        record_.warnings.push_back({code, where, text});
    }

    void read_one(std::int64_t mesh, std::int64_t primitive) {
        const std::string where = primitive_name(document_, mesh, primitive);
        const json& mesh_item = gltf_item(document_.json, "meshes", mesh, document_.name);
        const json& item = gltf_item(mesh_item, "primitives", primitive, where);
        if (!has_triangles(primitive_mode(document_, mesh, primitive)))
            return warn("no-triangles", where, "points and lines have no area: skipped");
        if (!json_object(item, "attributes", where).contains("POSITION"))
            return warn("no-positions", where, "has no POSITION: skipped");
        if (!json_array(item, "targets", where).empty())
            warn("morph-rest-pose", where, "morph targets are ignored: the mesh is baked in its rest pose");

        PrimitiveArrays arrays = read_primitive(document_, mesh, primitive, wanted_);
        PrimitiveRecord out;
        out.gltf_primitive = static_cast<int>(primitive);
        out.material = static_cast<int>(json_index(item, "material", gltf_count(document_.json, "materials"), where));
        out.positions = read_vectors<Imath::V3f>(arrays, "POSITION", "VEC3", where);
        out.normals = read_vectors<Imath::V3f>(arrays, "NORMAL", "VEC3", where);
        out.uv[0] = read_vectors<Imath::V2f>(arrays, "TEXCOORD_0", "VEC2", where);
        out.uv[1] = read_vectors<Imath::V2f>(arrays, "TEXCOORD_1", "VEC2", where);
        out.colors = read_colors(arrays, where, record_.warnings);
        out.indices = triangle_list(arrays.mode, arrays.indices);
        if (out.indices.empty()) return warn("no-triangles", where, "has no whole triangle: skipped");
        if (arrays.mode == PrimitiveMode::triangles && arrays.indices.size() % 3)
            warn("partial-triangle", where, "the number of indices is not a multiple of 3: the rest is ignored");
        record_.meshes[static_cast<std::size_t>(mesh)].primitives.push_back(std::move(out));
    }

    const GltfDocument& document_;
    SceneRecord& record_;
    std::vector<std::string> wanted_;
};

}  // namespace

int find_scene(const GltfDocument& document, const std::string& wanted) {
    const std::size_t count = gltf_count(document.json, "scenes");
    std::vector<std::string> names;
    std::vector<int> found;
    for (std::size_t k = 0; k < count; ++k) {
        const json& item = gltf_item(document.json, "scenes", static_cast<std::int64_t>(k), document.name);
        names.push_back(json_text(item, "name", "", document.name + ": scene " + std::to_string(k)));
        if (names.back() == wanted) found.push_back(static_cast<int>(k));
    }
    std::size_t number = 0;
    const auto end = std::from_chars(wanted.data(), wanted.data() + wanted.size(), number);
    if (end.ec == std::errc() && end.ptr == wanted.data() + wanted.size() && number < count) return static_cast<int>(number);
    if (found.size() == 1) return found[0];
    std::string list;
    for (std::size_t k = 0; k < count; ++k) list += (k ? ", " : "") + std::to_string(k) + (names[k].empty() ? "" : " \"" + names[k] + "\"");
    throw Error(ErrorCode::bad_input, document.name,
                "expected one scene that is called " + wanted + ", found " + std::to_string(found.size()) + " among: " + (count ? list : "none"),
                "give its number or its name");
}

SceneRecord read_scene(const GltfDocument& document, const ReadOptions& options) {
    SceneRecord record;
    record.warnings = document.warnings;
    if (gltf_count(document.json, "animations") > 0)
        record.warnings.push_back({"animation-rest-pose", document.name, "animations are ignored: the scene is baked at rest"});
    read_nodes(document, options.scene, options.skip_skinned, record);
    settle_nodes(document, options.settings ? *options.settings : SettingsFile(), record);
    read_sky(document, options, record);
    read_materials(document, options.external_images, record);

    std::set<int> shown;
    for (const InstanceRecord& instance : record.instances) shown.insert(instance.mesh);
    for (std::size_t m = 0; m < gltf_count(document.json, "meshes"); ++m) {
        const auto index = static_cast<std::int64_t>(m);
        const json& item = gltf_item(document.json, "meshes", index, document.name);
        const std::string name = json_text(item, "name", "", document.name + ": mesh " + std::to_string(m));
        record.meshes.push_back({name.empty() ? "mesh " + std::to_string(m) : name, {}});
    }
    MeshReader reader(document, options.vertex_colors, record);
    for (const int mesh : shown) reader.read(mesh);
    return record;
}

}  // namespace luxel
