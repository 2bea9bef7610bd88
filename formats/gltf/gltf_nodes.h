/// The node tree of one scene: which meshes and lamps are shown, where, and under which path.
///
/// Units    metres; world matrices in double precision, row vectors (p' = p * M).
/// Errors   Error{bad_input} naming the node: a cycle, a node with two parents, deeper than 1024 levels, bad indices.
/// Threads  pure functions.
/// Sizes    of lamps, which KHR_lights_punctual does not know: "radius" (metres; point, spot) and "angle" (degrees; directional)
///          in `extras` of the light or, before that, of the node.
/// Source   glTF 2.0 specification, section 3.5; KHR_lights_punctual; EXT_mesh_gpu_instancing.
#pragma once
#include "formats/gltf/gltf_document.h"
#include "formats/gltf/scene_record.h"

namespace luxel {

/// Appends instances, lamps and warnings to `record`, in document order of a depth-first walk. `scene` -1: the default.
/// A part of a path is the node's name, in which "/", "@" and "%" are written as %2F, %40 and %25, or "#index" without
/// one; the second sibling of one name gets ":1" and so on.
/// `skip_skinned`: nodes with a skin have no instance.
void read_nodes(const GltfDocument& document, int scene, bool skip_skinned, SceneRecord& record);

}  // namespace luxel
