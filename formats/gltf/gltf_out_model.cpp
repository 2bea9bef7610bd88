#include "formats/gltf/gltf_out_model.h"

#include <algorithm>

#include "formats/gltf/gltf_json.h"

namespace luxel {

using nlohmann::json;

OutputModel::OutputModel(const GltfDocument& input) : document(input), root(input.json) {
    views.resize(gltf_count(root, "bufferViews"));
    for (std::size_t index = 0; index < views.size(); ++index) views[index].source = static_cast<std::int64_t>(index);
}

std::uint64_t OutputModel::append(const char* array, json item) {
    json& items = root[array];
    if (!items.is_array()) items = json::array();
    items.push_back(std::move(item));
    return items.size() - 1;
}

std::uint64_t OutputModel::append_view(OutputView view, json item) {
    views.push_back(std::move(view));
    return append("bufferViews", std::move(item));
}

ByteView OutputModel::view_bytes(std::size_t view, const std::string& where) const {
    const OutputView& bytes = views[view];
    if (bytes.source >= 0) return document.view(bytes.source, where);
    return bytes.owned.empty() ? bytes.borrowed : ByteView(bytes.owned);
}

std::uint64_t OutputModel::view_stride(std::size_t view, const std::string& where) const {
    if (views[view].source >= 0) return document.view_stride(views[view].source);
    return json_size(root["bufferViews"][view], "byteStride", 0, where);
}

AccessorBytes OutputModel::elements(std::int64_t accessor, const std::string& where) const {
    const auto checked = [&](std::int64_t view, const std::string& here) {
        if (view < 0 || static_cast<std::size_t>(view) >= views.size())
            bad_gltf(here, "bufferView " + std::to_string(view) + " of " + std::to_string(views.size()));
        return static_cast<std::size_t>(view);
    };
    return read_elements(
        {root, [&](std::int64_t view, const std::string& here) { return view_bytes(checked(view, here), here); },
         [&](std::int64_t view) { return view_stride(checked(view, where), where); }},
        accessor, where);
}

namespace {

void add_name(json& root, const char* list, const std::string& name) {
    json& names = root[list];
    if (!names.is_array()) names = json::array();
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
}

}  // namespace

void use_extension(json& root, const std::string& name) { add_name(root, "extensionsUsed", name); }

void require_extension(json& root, const std::string& name) {
    use_extension(root, name);
    add_name(root, "extensionsRequired", name);
}

void drop_extension(json& root, const std::string& name) {
    for (const char* key : {"extensionsUsed", "extensionsRequired"}) {
        const auto list = root.find(key);
        if (list == root.end() || !list->is_array()) continue;
        list->erase(std::remove(list->begin(), list->end(), name), list->end());
        if (list->empty()) root.erase(key);
    }
}

bool has_extension(const json& tree, const std::string& name) {
    if (tree.is_array())
        return std::any_of(tree.begin(), tree.end(), [&](const json& item) { return has_extension(item, name); });
    if (!tree.is_object()) return false;
    for (const auto& [key, value] : tree.items()) {
        if (key == "extras") continue;
        if (key == "extensions" && value.is_object() && value.contains(name)) return true;
        if (has_extension(value, name)) return true;
    }
    return false;
}

void erase_extension(json& object, const std::string& name) {
    const auto extensions = object.find("extensions");
    if (extensions == object.end() || !extensions->is_object()) return;
    extensions->erase(name);
    if (extensions->empty()) object.erase("extensions");
}

}  // namespace luxel
