/// Materials that show a picture as it is. Private to the gltf_out files.
#pragma once
#include <cstdint>

#include "formats/gltf/gltf_out_model.h"
#include "formats/gltf/gltf_out_prune.h"

namespace luxel {

/// KHR_materials_unlit with `texture` through TEXCOORD_1 as its colour. Of the source stay name, extras, doubleSided and alphaMode; the
/// picture's alpha is how much of a texel is covered, so the cutoff of a mask is a half. A pane (KHR_materials_transmission) becomes
/// BLEND and lets through as much as its factor says.
nlohmann::json unlit_material(const nlohmann::json& source, std::uint64_t texture);

/// Removes the materials, textures, samplers and pictures of the input from a model whose primitives show none of them any longer,
/// and renumbers what is left; buffer views of the pictures are added to `replaced`. Does nothing where a primitive still shows one, or where an extension
/// of the root, a scene, a node or an animation might name one by its number. Call before pictures are taken along.
void drop_input_materials(OutputModel& model, ArrayReferences& replaced);

}  // namespace luxel
