#include "formats/gltf/node_settings.h"

#include <fnmatch.h>

#include <array>
#include <map>

#include "formats/gltf/gltf_json.h"

namespace luxel {

using nlohmann::json;

namespace {

/// Texels per metre: up to where --texels-per-metre goes; a 32-bit number must hold the smallest.
constexpr double thinnest = 1e-6, densest = 1e9;

/// Members of an object that holds settings; one of the pointers is null.
struct Member {
    const char* name;
    std::optional<bool> NodeSettings::*flag;
    std::optional<double> NodeSettings::*number;
};
constexpr std::array<Member, 5> members{{{"lightmap", &NodeSettings::lightmap, nullptr},
                                         {"texelsPerMetre", nullptr, &NodeSettings::texels_per_metre},
                                         {"castShadow", &NodeSettings::cast_shadow, nullptr},
                                         {"receive", &NodeSettings::receive, nullptr},
                                         {"twoSided", &NodeSettings::two_sided, nullptr}}};

std::string member_names() {
    std::string names;
    for (const Member& member : members) names += (names.empty() ? "" : ", ") + std::string(member.name);
    return names;
}

/// A value as a message shows it, short.
std::string shown(const json& value) {
    if (value.is_structured()) return std::string("an ") + value.type_name();
    const std::string text = value.dump(-1, ' ', false, json::error_handler_t::replace);
    constexpr std::size_t longest = 40;
    return text.size() > longest ? text.substr(0, longest) + " ..." : text;
}

/// Sets the member of that name; returns what is wrong with it, empty if nothing is.
std::string set_member(const std::string& name, const json& value, NodeSettings& settings) {
    for (const Member& member : members) {
        if (name != member.name) continue;
        if (member.flag) {
            if (!value.is_boolean()) return name + ": expected true or false, found " + shown(value);
            settings.*member.flag = value.get<bool>();
        } else {
            const double number = value.is_number() ? value.get<double>() : 0;
            if (!(number >= thinnest && number <= densest)) return name + ": expected a number from 1e-6 to 1e9, found " + shown(value);
            settings.*member.number = number;
        }
        return {};
    }
    return name + ": unknown; there are " + member_names();
}

NodeSettings settings_of_extras(const json& owner, const std::string& where, std::vector<Warning>& warnings) {
    NodeSettings settings;
    const auto extras = owner.find("extras");
    if (extras == owner.end() || !extras->is_object()) return settings;
    const auto own = extras->find("luxel");
    if (own == extras->end()) return settings;
    if (!own->is_object()) {
        warnings.push_back({"extras-ignored", where, "extras.luxel: expected an object, found " + shown(*own) + ": ignored"});
        return settings;
    }
    for (const auto& [name, value] : own->items())
        if (const std::string fault = set_member(name, value, settings); !fault.empty())
            warnings.push_back({"extras-ignored", where, "extras.luxel: " + fault + ": ignored"});
    return settings;
}

void replace(const NodeSettings& by, NodeSettings& settings) {
    for (const Member& member : members) {
        if (member.flag && by.*member.flag) settings.*member.flag = by.*member.flag;
        if (member.number && by.*member.number) settings.*member.number = by.*member.number;
    }
}

SettingsEntry read_entry(const json& item, const std::string& where) {
    if (!item.is_object()) bad_gltf(where, "expected an object, found " + shown(item));
    SettingsEntry entry;
    for (const auto& [name, value] : item.items()) {
        if (name == "match") {
            if (!value.is_string() || value.get_ref<const std::string&>().empty())
                bad_gltf(where, "match: expected a pattern of node names, found " + shown(value));
            entry.match = value.get<std::string>();
        } else if (name == "optional") {
            entry.optional = json_bool(item, "optional", false, where);
        } else if (const std::string fault = set_member(name, value, entry.settings); !fault.empty()) {
            bad_gltf(where, fault, "docs/settings.md lists what an entry may say");
        }
    }
    if (entry.match.empty()) bad_gltf(where, "\"match\" is missing", "it says which nodes are meant: \"match\": \"chair*\"");
    return entry;
}

bool matches(const std::string& pattern, const std::string& text) { return ::fnmatch(pattern.c_str(), text.c_str(), 0) == 0; }

}  // namespace

bool matches_node(const std::string& pattern, const std::string& name, const std::string& path) {
    if (pattern.find('/') == std::string::npos) return matches(pattern, name);
    // "@" in a name is written "%40" in a path: what follows one is the number of a copy.
    return matches(pattern, path) || matches(pattern, path.substr(0, path.find('@')));
}

SettingsFile parse_settings(ByteView text, const std::string& name) {
    const json root = parse_json_object(text, name, "a settings file looks like { \"nodes\": [ { \"match\": \"chair*\", \"lightmap\": false } ] }");
    SettingsFile file;
    file.name = name;
    for (const auto& [key, value] : root.items())
        if (key != "nodes") bad_gltf(name, key + ": unknown; there is nodes");
    const json& nodes = json_array(root, "nodes", name);
    for (std::size_t k = 0; k < nodes.size(); ++k) file.nodes.push_back(read_entry(nodes[k], name + ": nodes[" + std::to_string(k) + "]"));
    return file;
}

void settle_nodes(const GltfDocument& document, const SettingsFile& file, SceneRecord& record) {
    std::map<int, NodeSettings> of_mesh, of_node;  // each is read once, so that it warns once
    std::vector<bool> has_matched(file.nodes.size());
    for (InstanceRecord& instance : record.instances) {
        const json& mesh = gltf_item(document.json, "meshes", instance.mesh, document.name);
        const json& node = gltf_item(document.json, "nodes", instance.node, document.name);
        if (!of_mesh.contains(instance.mesh))
            of_mesh[instance.mesh] = settings_of_extras(mesh, document.name + ": " + gltf_name(mesh, "mesh", instance.mesh), record.warnings);
        if (!of_node.contains(instance.node))
            of_node[instance.node] = settings_of_extras(node, document.name + ": " + gltf_name(node, "node", instance.node), record.warnings);
        instance.settings = of_mesh[instance.mesh];
        replace(of_node[instance.node], instance.settings);
        std::string name = json_text(node, "name", "", document.name);
        if (name.empty()) name.append(1, '#').append(std::to_string(instance.node));
        for (std::size_t k = 0; k < file.nodes.size(); ++k) {
            if (!matches_node(file.nodes[k].match, name, instance.node_path)) continue;
            has_matched[k] = true;
            replace(file.nodes[k].settings, instance.settings);
        }
    }
    for (std::size_t k = 0; k < file.nodes.size(); ++k)
        if (!has_matched[k] && !file.nodes[k].optional)
            bad_gltf(file.name + ": nodes[" + std::to_string(k) + "]",
                     "\"" + file.nodes[k].match + "\" matches no node with a mesh in the scene that is baked",
                     "correct the pattern, or add \"optional\": true");
}

}  // namespace luxel
