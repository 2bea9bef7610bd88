#include "formats/gltf/gltf_out_nodes.h"

#include <algorithm>

#include "formats/gltf/gltf_json.h"

namespace luxel {

using nlohmann::json;

namespace {

constexpr const char* lightmap_extension = "MX_lightmap";

/// A member that is an object or a list; nullptr otherwise: what nobody has read may be anything.
const json* part_of(const json& parent, const char* key) {
    const auto found = parent.is_object() ? parent.find(key) : parent.end();
    return found != parent.end() && found->is_structured() ? &*found : nullptr;
}

/// Does a channel of this animation move the weights of the node?
bool moves_weights(const json& animation, std::uint64_t node) {
    const json* channels = part_of(animation, "channels");
    return channels && std::ranges::any_of(*channels, [&](const json& channel) {
        const json* target = part_of(channel, "target");
        return target && target->is_object() && target->value("node", json()) == json(node) && target->value("path", json()) == json("weights");
    });
}

}  // namespace

void NodeWriter::show(std::uint64_t node, const std::vector<ShownMesh>& meshes, const LayoutPlace& place) {
    set_mesh(model_.root["nodes"][node], meshes.front(), place);
    if (meshes.size() > 1) warn_of_weights(node);
    for (std::size_t k = 1; k < meshes.size(); ++k) {
        const json& shown = model_.root["nodes"][node];
        json child = {{"name", json_text(shown, "name", "", model_.document.name) + " (lightmap part " + std::to_string(k) + ")"}};
        for (const char* key : {"skin", "weights"})
            if (shown.contains(key)) child[key] = shown[key];
        set_mesh(child, meshes[k], place);
        const std::uint64_t index = model_.append("nodes", std::move(child));
        model_.root["nodes"][node]["children"].push_back(index);
    }
}

void NodeWriter::show_copies(json& node, const ShownMesh& mesh) { set_mesh(node, mesh, {}); }

void NodeWriter::set_mesh(json& node, const ShownMesh& shown, const LayoutPlace& place) {
    node["mesh"] = shown.mesh;
    erase_extension(node, lightmap_extension);  // of an earlier bake
    if (shown.page == no_node_page) return;
    const LightmapMeaning& meaning = lightmaps_.meaning;
    const auto page = static_cast<std::size_t>(shown.page);
    json lightmap = {{"lightMapTexture", {{"index", textures_[page]}, {"texCoord", 1}}},
                     {"intensity", lightmaps_.pages[page].intensity * meaning.lit_scale},
                     {"extras", lightmap_extras(meaning, meaning.lit_scale)}};
    if (!place.is_identity()) {
        lightmap["scale"] = {place.scale.x, place.scale.y};
        lightmap["offset"] = {place.offset.x, place.offset.y};
    }
    node["extensions"][lightmap_extension] = std::move(lightmap);
    use_extension(model_.root, lightmap_extension);
}

void NodeWriter::warn_of_weights(std::uint64_t node) {
    const std::string& name = model_.document.name;
    const json* animations = part_of(model_.root, "animations");
    if (!animations || std::ranges::none_of(*animations, [&](const json& animation) { return moves_weights(animation, node); })) return;
    model_.warnings.push_back({"part-not-animated", name + ": " + gltf_name(model_.root["nodes"][node], "node", static_cast<std::int64_t>(node)),
                               "it lies on several lightmap pages, so that children of it show parts; animated weights move its own part only"});
}

void NodeWriter::finish() {
    const json* nodes = part_of(model_.root, "nodes");
    if (!nodes || !has_extension(*nodes, lightmap_extension)) drop_extension(model_.root, lightmap_extension);
}

std::vector<bool> meshes_with_node_lightmap(const GltfDocument& document) {
    std::vector<bool> found(gltf_count(document.json, "meshes"), false);
    const json* nodes = part_of(document.json, "nodes");
    if (!nodes) return found;
    for (const json& node : *nodes) {
        const json* extensions = part_of(node, "extensions");
        if (!extensions || !part_of(*extensions, lightmap_extension)) continue;
        const std::int64_t mesh = json_index(node, "mesh", found.size(), document.name);
        if (mesh >= 0) found[static_cast<std::size_t>(mesh)] = true;
    }
    return found;
}

json lightmap_extras(const LightmapMeaning& meaning, double scale) {
    json extras = {{"quantity", meaning.quantity}, {"unit", meaning.unit},       {"encoding", meaning.encoding},
                   {"format", meaning.format},     {"profile", meaning.profile}, {"irradianceFactor", 1 / scale}};
    if (meaning.range > 0) extras["range"] = meaning.range;
    return extras;
}

}  // namespace luxel
