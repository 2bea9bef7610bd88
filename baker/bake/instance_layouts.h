/// Atlas -> the lightmap layout of every instance of the file, as the model's writer wants it.
#pragma once
#include <vector>

#include "baker/bake/geometry_stages.h"
#include "formats/gltf/gltf_out.h"

namespace luxel {

/// Copies by EXT_mesh_gpu_instancing: MOZ_lightmap readers take their places from attributes, other textures have no such thing.
enum class SharedNodes { keep, split };

/// As SceneRecord::instances. Coordinates are relative to the instance's block where it has one, so that those of all copies of a mesh
/// are equal and its geometry is stored once; else to the page, and the place is the identity. With SharedNodes::split that is so for copies that share their node too.
std::vector<InstanceLayout> instance_layouts(const BakedGeometry& geometry, SharedNodes shared_nodes = SharedNodes::keep);

}  // namespace luxel
