/// What artists say about single nodes: `extras.luxel` of nodes and meshes, and a settings file. docs/settings.md has both.
///
/// Order    a mesh says it for all nodes that show it, a node for itself, an entry of the file for all nodes that it matches; each
///          replaces what those before it have said, member by member. Nothing is inherited by the children of a node.
/// Errors   in the file: Error{bad_input} that names entry and member. In extras, which belong to whoever wrote them: a warning, and
///          what cannot be read is ignored.
/// Threads  pure functions but for `warnings`.
#pragma once
#include "formats/gltf/gltf_document.h"
#include "formats/gltf/scene_record.h"

namespace luxel {

/// One entry of the file's "nodes".
struct SettingsEntry {
    std::string match;      ///< pattern of names, or with a "/" of paths
    bool optional = false;  ///< need not match anything
    NodeSettings settings;
};

struct SettingsFile {
    std::string name;  ///< for messages
    std::vector<SettingsEntry> nodes;
};

/// Does the pattern match the node? "*" is any characters, "?" is one, "[ab]" one of these; all of the name or path must match.
/// `name`: as the file has it, "#3" for a node without one. `path`: InstanceRecord::node_path, for a copy of EXT_mesh_gpu_instancing with or
/// without its "@k".
bool matches_node(const std::string& pattern, const std::string& name, const std::string& path);

/// The settings file, from its bytes.
SettingsFile parse_settings(ByteView text, const std::string& name);

/// Sets InstanceRecord::settings of all instances. Error{bad_input} for an entry that matches no node with a mesh, unless it is
/// optional.
void settle_nodes(const GltfDocument& document, const SettingsFile& file, SceneRecord& record);

}  // namespace luxel
