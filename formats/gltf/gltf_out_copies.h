/// Places on the pages for copies by EXT_mesh_gpu_instancing: attributes of the extension. Private to the gltf_out files.
#pragma once
#include <vector>

#include "formats/gltf/gltf_out.h"
#include "formats/gltf/gltf_out_arrays.h"
#include "formats/gltf/gltf_out_model.h"
#include "formats/gltf/gltf_out_nodes.h"

namespace luxel {

/// One copy of a node.
struct NodeCopy {
    std::uint32_t number = 0;  ///< element of the extension's attributes
    const InstanceLayout* layout = nullptr;
};

/// Copies of a node among the instances of the record.
std::vector<NodeCopy> copies_of(const SceneRecord& record, const GltfLightmaps& lightmaps, const std::vector<std::size_t>& instances);

/// If all layouts have a place of their own: gives the node the mesh and the attributes of those copies that have one layout on one page; for each further layout or page
/// the node gets a child with that part of the copies. Copies without a layout keep the mesh of the input.
/// Else the copies become ordinary nodes, children of this one, which loses its mesh and the extension; a warning names attributes
/// of the extension that are lost by that.
void place_copies(OutputModel& model, ArrayStore& arrays, NodeWriter& nodes, int node, const std::vector<NodeCopy>& copies, const MeshMaker& make_meshes);

}  // namespace luxel
