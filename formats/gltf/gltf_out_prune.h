/// Removes arrays that only replaced primitives used, and renumbers what is left. Private to the gltf_out files.
///
/// Only accessors, and buffer views, that the replaced primitives referred to can go: what nothing used in the input
/// stays as it was. Where an accessor that stays lies in a view of which another part goes, it gets a view of its own.
/// Known places of references: primitives (attributes, indices, targets, Draco), skins, animation samplers, pictures,
/// EXT_mesh_gpu_instancing. If an extension that is unknown here holds whole numbers, nothing is removed: they might be
/// references.
#pragma once
#include <cstdint>
#include <set>
#include <string_view>

#include "formats/gltf/gltf_out_arrays.h"
#include "formats/gltf/gltf_out_model.h"

namespace luxel {

struct ArrayReferences {
    std::set<std::uint64_t> accessors, views;
};

/// What the primitives of a mesh refer to; views only those of Draco.
void collect_references(const nlohmann::json& mesh, ArrayReferences& found);

/// Is this the content of an extension that is unknown here and may name objects by number?
bool may_hold_references(std::string_view extension, const nlohmann::json& content);

/// `replaced`: what meshes referred to that are no longer in the model as they were.
void prune_arrays(OutputModel& model, const ArrayReferences& replaced);

}  // namespace luxel
