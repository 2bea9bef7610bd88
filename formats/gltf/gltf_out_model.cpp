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

void use_extension(json& root, const std::string& name) {
    json& used = root["extensionsUsed"];
    if (!used.is_array()) used = json::array();
    if (std::find(used.begin(), used.end(), name) == used.end()) used.push_back(name);
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
