#include "formats/gltf/gltf_node_owners.h"

#include <algorithm>
#include <cstdlib>
#include <set>

#include "formats/gltf/gltf_json.h"
#include "formats/gltf/gltf_references.h"

namespace luxel {

using nlohmann::json;

namespace {

/// Nodes that animations move, and those that take part in skins.
std::set<std::uint64_t> moving_nodes(const json& root) {
    std::set<std::uint64_t> moving;
    for (const json& animation : json_array(root, "animations", "animations"))
        for (const json& channel : json_array(animation, "channels", "animation")) {
            const json& target = json_object(channel, "target", "animation");
            if (const auto node = target.find("node"); node != target.end() && node->is_number_unsigned()) moving.insert(node->get<std::uint64_t>());
            const json* extension = json_extension(target, "KHR_animation_pointer", "animation");
            const std::string path = extension ? json_text(*extension, "pointer", "", "animation") : "";
            if (path.starts_with("/nodes/")) moving.insert(std::strtoull(path.c_str() + 7, nullptr, 10));
        }
    for (const json& skin : json_array(root, "skins", "skins"))
        for (const json& joint : json_array(skin, "joints", "skin"))
            if (joint.is_number_unsigned()) moving.insert(joint.get<std::uint64_t>());
    return moving;
}

}  // namespace

NodeOwners find_node_owners(const json& root, const GltfSplit& split) {
    const std::size_t count = gltf_count(root, "nodes");
    NodeOwners owners;
    owners.scene = split.scene >= 0 ? split.scene : default_scene(root);
    owners.parent.assign(count, -1);
    owners.owner.assign(count, no_part);
    const std::set<std::uint64_t> moving = moving_nodes(root);
    std::vector<std::uint64_t> open = scene_roots(root, owners.scene);
    std::vector<bool> moves(count, false);
    std::reverse(open.begin(), open.end());
    while (!open.empty()) {
        const std::uint64_t number = open.back();
        open.pop_back();
        if (number >= count || owners.owner[number] != no_part) continue;
        const json& node = gltf_item(root, "nodes", static_cast<std::int64_t>(number), "nodes");
        const std::int64_t parent = owners.parent[number];
        moves[number] = moving.contains(number) || node.contains("skin") || (parent >= 0 && moves[static_cast<std::size_t>(parent)]);
        // Nodes that the writer has added show copies or parts of what they hang on.
        std::size_t of_input = number;
        while (of_input >= split.part_of_node.size() && owners.parent[of_input] >= 0) of_input = static_cast<std::size_t>(owners.parent[of_input]);
        const bool may_be_apart = node.contains("mesh") && !moves[number] && of_input < split.part_of_node.size();
        owners.owner[number] = may_be_apart ? split.part_of_node[of_input] : common_part;
        owners.order.push_back(number);
        const json& children = json_array(node, "children", "node");
        for (auto child = children.rbegin(); child != children.rend(); ++child) {
            const std::uint64_t index = json_value_size(*child, "child", "node");
            if (index >= count || owners.owner[index] != no_part) continue;
            owners.parent[index] = static_cast<std::int64_t>(number);
            open.push_back(index);
        }
    }
    return owners;
}

}  // namespace luxel
