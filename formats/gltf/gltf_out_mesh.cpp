#include "formats/gltf/gltf_out_mesh.h"

#include "formats/gltf/gltf_json.h"

namespace luxel {

using nlohmann::json;

namespace {

constexpr const char* variants_extension = "KHR_materials_variants";
constexpr const char* draco_extension = "KHR_draco_mesh_compression";
constexpr int mode_triangles = 4;

const json& mesh_item(const GltfDocument& document, std::int64_t mesh) {
    return gltf_item(document.json, "meshes", mesh, document.name);
}

/// The accessor object behind a number of the input, or nullptr.
const json* accessor_object(const GltfDocument& document, const json& index) {
    const auto accessors = document.json.find("accessors");
    if (accessors == document.json.end() || !index.is_number_unsigned() ||
        index.get<std::uint64_t>() >= accessors->size())
        return nullptr;
    return &(*accessors)[index.get<std::size_t>()];
}

/// Every material that a primitive may show: its own, and those of its variants.
std::vector<std::int64_t> materials_of(const json& primitive, std::size_t material_count, const std::string& where) {
    std::vector<std::int64_t> materials{json_index(primitive, "material", material_count, where)};
    if (const json* variants = json_extension(primitive, variants_extension, where))
        for (const json& mapping : json_array(*variants, "mappings", where))
            materials.push_back(json_index(mapping, "material", material_count, where));
    return materials;
}

AccessorBytes uv_elements(const std::vector<Imath::V2f>& uv) {
    AccessorBytes elements;
    elements.components = 2;
    elements.type = "VEC2";
    elements.count = uv.size();
    ByteWriter writer;
    for (const Imath::V2f& point : uv) {
        writer.put(point.x);
        writer.put(point.y);
    }
    elements.data = writer.take();
    return elements;
}

}  // namespace

std::vector<SourcePrimitive> MeshRewriter::read_mesh(std::int64_t mesh, const MeshRecord& record) const {
    const GltfDocument& document = model_.document;
    std::vector<SourcePrimitive> sources;
    for (const PrimitiveRecord& primitive : record.primitives) {
        SourcePrimitive& source = sources.emplace_back();
        source.primitive = primitive.gltf_primitive;
        source.where = primitive_name(document, mesh, source.primitive);
        source.arrays = read_primitive(document, mesh, source.primitive);
        source.triangles = triangle_list(source.arrays.mode, source.arrays.indices);
        const json& item = gltf_item(mesh_item(document, mesh), "primitives", source.primitive, source.where);
        for (const json& target : json_array(item, "targets", source.where)) {
            auto& arrays = source.targets.emplace_back();
            for (const auto& [semantic, accessor] : target.items()) {
                const std::string here = source.where + ": target " + semantic;
                const auto index = static_cast<std::int64_t>(json_value_size(accessor, "accessor", here));
                const AccessorBytes& array = arrays[semantic] = read_elements(document, index, here);
                if (array.count != source.arrays.vertex_count)
                    bad_gltf(here, "has " + std::to_string(array.count) + " elements, POSITION has " +
                                       std::to_string(source.arrays.vertex_count));
            }
        }
    }
    return sources;
}

LaidOutMesh MeshRewriter::lay_out(std::int64_t mesh, const std::vector<SourcePrimitive>& sources, const MeshLayout& layout) {
    LaidOutMesh result{mesh, mesh_item(model_.document, mesh), {}};
    const json old_primitives = json_array(result.mesh, "primitives", model_.document.name);
    json& primitives = result.mesh["primitives"] = json::array();
    std::size_t next = 0;
    for (std::size_t p = 0; p < old_primitives.size(); ++p) {
        std::vector<PagePart> parts;
        if (next < sources.size() && sources[next].primitive == static_cast<std::int64_t>(p)) {
            const SourcePrimitive& source = sources[next];
            parts = split_by_layout(source.triangles, source.arrays.vertex_count, layout[next], page_count_, source.where);
            ++next;
            const std::uint64_t moved_set = parts.empty() ? 0 : choose_moved_set(mesh, old_primitives[p]);
            for (const PagePart& part : parts) {
                result.parts.push_back({primitives.size(), static_cast<std::int64_t>(p), part.page, moved_set});
                primitives.push_back(make_part(old_primitives[p], source, part, moved_set));
            }
        }
        if (parts.empty()) primitives.push_back(old_primitives[p]);
    }
    return result;
}

std::set<std::uint32_t> LaidOutMesh::pages() const {
    std::set<std::uint32_t> pages;
    for (const Part& part : parts) pages.insert(part.page);
    return pages;
}

/// material_of(material of the input) is what the part shows instead, -1 the default material.
template <class Material>
void MeshRewriter::set_materials(const LaidOutMesh& laid_out, const LaidOutMesh::Part& part, json& primitive, const Material& material_of) {
    const std::string where = primitive_name(model_.document, laid_out.source, part.source);
    const auto set = [&](json& owner) {
        const std::int64_t material = material_of(json_index(owner, "material", gltf_count(model_.document.json, "materials"), where));
        if (material >= 0) owner["material"] = static_cast<std::uint64_t>(material);
    };
    set(primitive);
    if (json_extension(primitive, variants_extension, where))
        for (json& mapping : primitive["extensions"][variants_extension]["mappings"]) set(mapping);
}

json MeshRewriter::at_place(const LaidOutMesh& laid_out, const LayoutPlace& place) {
    json mesh = laid_out.mesh;
    for (const LaidOutMesh::Part& part : laid_out.parts)
        set_materials(laid_out, part, mesh["primitives"][part.primitive], [&](std::int64_t material) {
            return static_cast<std::int64_t>(materials_.clone(material, part.page, place, part.moved_uv_set));
        });
    return mesh;
}

json MeshRewriter::on_page(const LaidOutMesh& laid_out, std::uint32_t page) {
    json mesh = laid_out.mesh;
    const bool is_first = page == *laid_out.pages().begin();
    json& primitives = mesh["primitives"] = json::array();
    auto part = laid_out.parts.begin();
    for (std::size_t p = 0; p < laid_out.mesh["primitives"].size(); ++p) {
        const bool has_page = part != laid_out.parts.end() && part->primitive == p;
        if (has_page ? part->page == page : is_first) {
            primitives.push_back(laid_out.mesh["primitives"][p]);
            if (has_page)
                set_materials(laid_out, *part, primitives.back(), [&](std::int64_t material) { return materials_.without_lightmap(material, part->moved_uv_set); });
        }
        if (has_page) ++part;
    }
    return mesh;
}

/// Where TEXCOORD_1 of the input goes: the next free set; 0 if there is none, or if only an older lightmap used it.
std::uint64_t MeshRewriter::choose_moved_set(std::int64_t mesh, const json& item) const {
    const json& attributes = item["attributes"];
    if (!attributes.contains("TEXCOORD_1")) return 0;
    bool has_old_lightmap = has_old_layout_[static_cast<std::size_t>(mesh)], is_used = uses_uv_set(item, 1);
    const std::size_t material_count = gltf_count(model_.document.json, "materials");
    for (const std::int64_t material : materials_of(item, material_count, model_.document.name)) {
        const json& source = materials_.source(material);
        is_used = is_used || uses_uv_set(source, 1);
        has_old_lightmap = has_old_lightmap || json_extension(source, "MOZ_lightmap", model_.document.name);
    }
    if (has_old_lightmap && !is_used) return 0;
    std::uint64_t set = 2;
    while (attributes.contains("TEXCOORD_" + std::to_string(set))) ++set;
    return set;
}

json MeshRewriter::gather_attributes(const json& accessors_by_name, const std::map<std::string, AccessorBytes>& arrays,
                                     const PagePart& part, std::uint64_t moved_set) {
    json attributes = json::object();
    for (const auto& [semantic, elements] : arrays) {
        const bool is_old_uv = semantic == "TEXCOORD_1";
        if (is_old_uv && !moved_set) continue;
        const std::string name = is_old_uv ? "TEXCOORD_" + std::to_string(moved_set) : semantic;
        const json* like = accessor_object(model_.document, accessors_by_name[semantic]);
        attributes[name] = arrays_.add(gather_elements(elements, part.source_vertex), ArrayUse::vertices, like,
                                       semantic == "POSITION");
    }
    return attributes;
}

/// TEXCOORD_1, and TEXCOORD_0 where the primitive has none: sets have to be numbered without gaps. A textured material
/// then gets zeros, which is what viewers take for a missing set; others share the new array.
void MeshRewriter::add_lightmap_uv(const json& item, const std::string& where, const PagePart& part, json& attributes) {
    const std::uint64_t uv = arrays_.add(uv_elements(part.uv), ArrayUse::vertices, nullptr, false);
    attributes["TEXCOORD_1"] = uv;
    if (attributes.contains("TEXCOORD_0")) return;
    attributes["TEXCOORD_0"] = uv;
    const std::size_t material_count = gltf_count(model_.document.json, "materials");
    for (const std::int64_t material : materials_of(item, material_count, where))
        if (has_texture(materials_.source(material)))
            attributes["TEXCOORD_0"] = arrays_.add(uv_elements(std::vector<Imath::V2f>(part.uv.size(), {0.0f, 0.0f})),
                                                   ArrayUse::vertices, nullptr, false);
}

json MeshRewriter::make_part(const json& item, const SourcePrimitive& source, const PagePart& part, std::uint64_t moved_set) {
    json primitive = item;
    erase_extension(primitive, draco_extension);
    if (moved_set && primitive.contains("extensions")) change_uv_set(primitive["extensions"], 1, moved_set);
    primitive["mode"] = mode_triangles;
    json attributes = gather_attributes(item["attributes"], source.arrays.attributes, part, moved_set);
    add_lightmap_uv(item, source.where, part, attributes);
    primitive["attributes"] = std::move(attributes);
    const json* old_indices = item.contains("indices") ? accessor_object(model_.document, item["indices"]) : nullptr;
    primitive["indices"] = arrays_.add_indices(part.indices, part.uv.size(), old_indices);
    for (std::size_t target = 0; target < source.targets.size(); ++target)
        primitive["targets"][target] =
            gather_attributes(item["targets"][target], source.targets[target], part, moved_set);
    return primitive;
}

}  // namespace luxel
