/// Materials, textures and images of a document, as far as they say how surfaces reflect, emit and let light through.
///
/// Units    base colour and emission factors linear; emission in nits; UV transforms as TextureUse says.
/// Images   are read only where a material uses them for colour, emission or transmission; others keep empty bytes without a warning.
/// Errors   Error{bad_input}: members of a wrong type, indices out of range. Missing images are warnings.
/// Threads  pure functions.
/// Source   glTF 2.0 specification, section 3.9 and 3.8; the KHR_materials_* extensions; KHR_texture_transform.
#pragma once
#include "formats/gltf/gltf_document.h"
#include "formats/gltf/scene_record.h"

namespace luxel {

/// Fills record.materials, textures and images; appends warnings. `external_images`: read files beside the document too.
void read_materials(const GltfDocument& document, bool external_images, SceneRecord& record);

/// Image `index` of the document, for who else needs pictures. Bytes that cannot be had are empty, with a warning.
ImageRecord read_image(const GltfDocument& document, std::int64_t index, bool external_images, std::vector<Warning>& warnings);

}  // namespace luxel
