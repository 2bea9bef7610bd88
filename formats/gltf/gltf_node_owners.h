/// Which file of a split model each node of the scene belongs to. Private to the gltf_out files.
///
/// Rule     what GltfSplit says for nodes with a mesh (for their nearest ancestor of the input, if the writer has added them: gltf_out_nodes.h), except for what moves or hangs on something that moves (targets of
///          animations, nodes with a skin, joints): that and all others are common.
/// Threads  pure.
#pragma once
#include <cstdint>
#include <nlohmann/json.hpp>
#include <vector>

#include "formats/gltf/gltf_packing.h"

namespace luxel {

constexpr std::int64_t common_part = -1, no_part = -2;

struct NodeOwners {
    std::int64_t scene = -1;           ///< that is split; -1: a file without scenes
    std::vector<std::uint64_t> order;  ///< nodes of the scene, depth first, each once
    std::vector<std::int64_t> parent;  ///< per node: its parent, -1 for roots
    std::vector<std::int64_t> owner;   ///< per node: a part, common_part, or no_part outside of the scene
};

NodeOwners find_node_owners(const nlohmann::json& root, const GltfSplit& split);

}  // namespace luxel
