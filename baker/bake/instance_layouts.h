/// Atlas -> the lightmap layout of every instance of the file, as the model's writer wants it.
#pragma once
#include <vector>

#include "baker/bake/geometry_stages.h"
#include "formats/gltf/gltf_out.h"

namespace luxel {

/// As SceneRecord::instances. Coordinates are relative to the instance's block where it has one, so that those of all copies of a mesh
/// are equal and its geometry is stored once; else to the page, and the place is the identity.
std::vector<InstanceLayout> instance_layouts(const BakedGeometry& geometry);

}  // namespace luxel
