/// The two geometry codecs of glTF: meshopt buffer views and Draco meshes (within the bounds of gltf_draco_decoder.h).
///
/// Errors   Error{bad_input} naming who uses the data: every size is checked before a decoder runs, so that damaged
///          files end in a message, never in a crash or an allocation that the file's own size does not justify.
/// Threads  pure functions.
/// Source   EXT_meshopt_compression, KHR_meshopt_compression (bitstream version 0), KHR_draco_mesh_compression.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "formats/gltf/gltf_accessor.h"

namespace luxel {

/// Member of a buffer view's `extensions` that makes it compressed, or nullptr.
const nlohmann::json* meshopt_extension(const nlohmann::json& view, const std::string& where);

/// The decoded bytes of a compressed view: count * byteStride of them. `extension` as returned above.
Bytes decode_meshopt_view(const GltfDocument& document, const nlohmann::json& extension, const std::string& where);

struct DracoAttribute {
    std::string semantic;
    std::uint32_t unique_id = 0;  ///< of the attribute inside the stream
    AccessorBytes layout;         ///< what the accessor promises; data empty
};

struct DracoMesh {
    std::map<std::string, AccessorBytes> attributes;  ///< by semantic, in the component type of the layout
    std::vector<std::uint32_t> indices;               ///< 3 per triangle
    std::uint64_t vertex_count = 0;
};

/// Decodes one Draco stream. Attributes that are not asked for are left out.
DracoMesh decode_draco(ByteView stream, const std::vector<DracoAttribute>& wanted, const std::string& where);

}  // namespace luxel
