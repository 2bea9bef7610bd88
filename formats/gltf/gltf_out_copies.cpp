#include "formats/gltf/gltf_out_copies.h"

#include <algorithm>

#include "formats/gltf/gltf_json.h"

namespace luxel {

using nlohmann::json;

namespace {

constexpr const char* instancing = "EXT_mesh_gpu_instancing";

/// Copies that one node can show: their light differs by place only.
struct CopyPart {
    const InstanceLayout* layout = nullptr;  ///< of the first; all have that mesh layout
    std::vector<const NodeCopy*> copies;
};

std::vector<CopyPart> parts_of(const std::vector<NodeCopy>& copies) {
    std::vector<CopyPart> parts;
    for (const NodeCopy& copy : copies) {
        const auto found = std::find_if(parts.begin(), parts.end(), [&](const CopyPart& part) { return part.layout->mesh == copy.layout->mesh; });
        if (found != parts.end()) found->copies.push_back(&copy);
        else parts.push_back({copy.layout, {&copy}});
    }
    return parts;
}

AccessorBytes pairs(const CopyPart& part, Imath::V2f LayoutPlace::*member) {
    AccessorBytes elements;
    elements.components = 2;
    elements.type = "VEC2";
    elements.count = part.copies.size();
    ByteWriter writer;
    for (const NodeCopy* copy : part.copies) {
        const Imath::V2f& value = copy->layout->place.*member;
        writer.put(value.x);
        writer.put(value.y);
    }
    elements.data = writer.take();
    return elements;
}

/// The part's elements of an attribute, as a new accessor.
std::uint64_t part_attribute(OutputModel& model, ArrayStore& arrays, const json& accessor, const std::vector<std::uint32_t>& numbers, const std::string& where) {
    const auto index = static_cast<std::int64_t>(json_value_size(accessor, "accessor", where));
    const AccessorBytes elements = read_elements(model.document, index, where);
    if (elements.count <= *std::max_element(numbers.begin(), numbers.end()))
        bad_gltf(where, "has " + std::to_string(elements.count) + " elements, another attribute has more");
    return arrays.add(gather_elements(elements, numbers), ArrayUse::other, &gltf_item(model.document.json, "accessors", index, where), false);
}

/// The extension with the part's elements of every attribute, and their places. What reading has not looked at may be damaged: an
/// attribute whose elements cannot be chosen from is left out, with a warning.
json part_extension(OutputModel& model, ArrayStore& arrays, const json& whole, const CopyPart& part, bool is_all, const std::string& where) {
    json extension = whole;
    json& attributes = extension["attributes"];
    if (!is_all) {
        std::vector<std::uint32_t> numbers;
        for (const NodeCopy* copy : part.copies) numbers.push_back(copy->number);
        for (auto attribute = attributes.begin(); attribute != attributes.end();) {
            try {
                *attribute = part_attribute(model, arrays, *attribute, numbers, where + ": " + instancing + ' ' + attribute.key());
                ++attribute;
            } catch (const Error& error) {
                model.warnings.push_back({"instance-attribute-lost", error.where, error.what_text});
                attribute = attributes.erase(attribute);
            }
        }
    }
    if (!part.layout->mesh) return extension;
    attributes["_LIGHTMAP_OFFSET"] = arrays.add(pairs(part, &LayoutPlace::offset), ArrayUse::other, nullptr, false);
    attributes["_LIGHTMAP_SCALE"] = arrays.add(pairs(part, &LayoutPlace::scale), ArrayUse::other, nullptr, false);
    return extension;
}

/// An attribute of the extension and the member of a node that says the same.
struct CopyColumn {
    const char* semantic;
    const char* member;
    std::vector<float> numbers;
    std::size_t width;
};

std::vector<CopyColumn> read_columns(OutputModel& model, const json& extension, const std::string& where) {
    std::vector<CopyColumn> columns{{"TRANSLATION", "translation", {}, 3}, {"ROTATION", "rotation", {}, 4}, {"SCALE", "scale", {}, 3}};
    for (const auto& [semantic, accessor] : json_object(extension, "attributes", where).items()) {
        const std::string here = where + ": " + instancing + ' ' + semantic;
        const auto column = std::find_if(columns.begin(), columns.end(), [&, s = semantic](const CopyColumn& c) { return s == c.semantic; });
        if (column == columns.end()) {
            model.warnings.push_back({"instance-attribute-lost", here, "nodes have no place for it"});
            continue;
        }
        const AccessorBytes elements = read_elements(model.document, static_cast<std::int64_t>(json_value_size(accessor, "accessor", here)), here);
        if (elements.components != column->width) bad_gltf(here, "expected VEC" + std::to_string(column->width) + ", found " + elements.type);
        column->numbers = to_floats(elements);
    }
    return columns;
}

void split_copies(OutputModel& model, NodeWriter& nodes, int node, const std::vector<NodeCopy>& copies, const json& item, const MeshMaker& make_meshes, const std::string& where) {
    const std::vector<CopyColumn> columns = read_columns(model, item["extensions"][instancing], where);
    const std::string name = json_text(item, "name", "", where);
    for (const NodeCopy& copy : copies) {
        json child = {{"name", name + "@" + std::to_string(copy.number)}};
        child["mesh"] = item["mesh"];
        for (const CopyColumn& column : columns) {
            if (column.numbers.size() < (copy.number + std::size_t{1}) * column.width) continue;
            const auto first = column.numbers.begin() + static_cast<std::ptrdiff_t>(copy.number * column.width);
            child[column.member] = std::vector<float>(first, first + static_cast<std::ptrdiff_t>(column.width));
        }
        const std::uint64_t index = model.append("nodes", std::move(child));
        model.root["nodes"][static_cast<std::size_t>(node)]["children"].push_back(index);
        if (copy.layout->mesh) nodes.show(index, make_meshes(*copy.layout->mesh, copy.layout->place), copy.layout->place);
    }
    json& shown = model.root["nodes"][static_cast<std::size_t>(node)];
    shown.erase("mesh");
    erase_extension(shown, instancing);
    if (!has_extension(model.root, instancing)) drop_extension(model.root, instancing);
}

}  // namespace

std::vector<NodeCopy> copies_of(const SceneRecord& record, const GltfLightmaps& lightmaps, const std::vector<std::size_t>& instances) {
    std::vector<NodeCopy> copies;
    for (const std::size_t index : instances)
        copies.push_back({static_cast<std::uint32_t>(record.instances[index].gpu_instance), &lightmaps.instances[index]});
    return copies;
}

void place_copies(OutputModel& model, ArrayStore& arrays, NodeWriter& nodes, int node, const std::vector<NodeCopy>& copies, const MeshMaker& make_meshes) {
    const json& item = gltf_item(model.document.json, "nodes", node, model.document.name);
    const std::string where = model.document.name + ": " + gltf_name(item, "node", node);
    const bool have_places = std::none_of(copies.begin(), copies.end(), [](const NodeCopy& copy) { return copy.layout->mesh && copy.layout->place.is_identity(); });
    if (!have_places) return split_copies(model, nodes, node, copies, item, make_meshes, where);
    const std::vector<CopyPart> parts = parts_of(copies);
    for (std::size_t p = 0; p < parts.size(); ++p) {
        json shown = p == 0 ? model.root["nodes"][static_cast<std::size_t>(node)] : json::object();
        if (p > 0) {
            shown["name"] = json_text(item, "name", "", where) + " (lightmap part " + std::to_string(p) + ")";
            if (item.contains("weights")) shown["weights"] = item["weights"];
        }
        shown["mesh"] = item["mesh"];
        if (parts[p].layout->mesh) nodes.show_copies(shown, make_meshes(*parts[p].layout->mesh, {}).front());
        shown["extensions"][instancing] = part_extension(model, arrays, item["extensions"][instancing], parts[p], parts.size() == 1, where);
        if (p == 0) {
            model.root["nodes"][static_cast<std::size_t>(node)] = std::move(shown);
            continue;
        }
        const std::uint64_t child = model.append("nodes", std::move(shown));
        model.root["nodes"][static_cast<std::size_t>(node)]["children"].push_back(child);
    }
}

}  // namespace luxel
