/// Where the objects of a glTF file name each other by number. Private to the gltf_out files.
///
/// Known    glTF 2.0; KHR_draco_mesh_compression, KHR_materials_* and whatever holds a texture under a name that ends in
///          "Texture", KHR_materials_variants, KHR_lights_punctual, KHR_texture_basisu and the other extensions of
///          textures, EXT_mesh_gpu_instancing, EXT_lights_image_based, MOZ_lightmap, MX_lightmap, MSFT_lod. `extras` are never searched.
/// Threads  pure.
#pragma once
#include <functional>
#include <nlohmann/json.hpp>
#include <string>

#include "formats/gltf/gltf_out_arrays.h"

namespace luxel {

/// Kinds of objects that are named by number; the top-level array of each has this name, lights are in
/// extensions.KHR_lights_punctual.
enum class GltfKind { accessor, buffer_view, mesh, material, texture, sampler, image, skin, node, camera, light };

/// Called with every number, which it may change; `use` tells accessors apart.
using ReferenceVisitor = std::function<void(GltfKind kind, nlohmann::json& number, ArrayUse use)>;

/// The references inside one object: of a mesh its accessors and materials, of a node its mesh, children and so on. Those
/// of the objects named there are not followed. Numbers that are not whole are skipped.
void visit_references(GltfKind kind, nlohmann::json& object, const ReferenceVisitor& visit);

/// The number of the default scene, or of the first; -1 without scenes.
std::int64_t default_scene(const nlohmann::json& root);
/// The root nodes of a scene; of a file without scenes (-1) the nodes that are nobody's child.
std::vector<std::uint64_t> scene_roots(const nlohmann::json& root, std::int64_t scene);

}  // namespace luxel
