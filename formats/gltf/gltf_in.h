/// glTF -> SceneRecord: walks the nodes of one scene and reads what surfaces and light need.
///
/// Shapes     local float arrays per primitive, double world matrices per instance; metres, Y up, as in the file.
/// Skipped    with a warning each: points and lines, skins (rest pose, or left out) and morph targets (rest pose), images that are
///            missing or of a format that cannot be decoded here, material extensions that change only what mirrors.
/// Errors     Error{bad_input} naming mesh and primitive or the node: damaged arrays, index out of range, node cycles.
/// Threads    pure functions of the document.
#pragma once
#include <filesystem>

#include "formats/gltf/gltf_document.h"
#include "formats/gltf/scene_record.h"

namespace luxel {

struct SettingsFile;

struct ReadOptions {
    int scene = -1;              ///< index of the scene; -1: the file's default, else its first
    bool external_images = true;  ///< read image files beside the document; false: only embedded ones
    bool skip_skinned = false;    ///< leave out nodes with a skin, which move; false: they stand in their rest pose
    bool vertex_colors = true;    ///< read COLOR_0; false: as if no mesh had it
    const SettingsFile* settings = nullptr;  ///< of nodes, before what their extras say (node_settings.h)
};

/// The scene that a user means, by number or by name; a name that is a number is the number. Throws Error{bad_input} that lists what
/// there is: none of that name, or several.
int find_scene(const GltfDocument& document, const std::string& wanted);

/// Meshes, materials, textures and images keep the numbers that they have in the file; meshes without an instance in the
/// scene have no primitives read. A file without a scene shows all root nodes.
SceneRecord read_scene(const GltfDocument& document, const ReadOptions& options = {});

}  // namespace luxel
