/// Writes a finished model again in parts, each a GLB of its own, for engines that load a scene piece by piece.
/// Private to the gltf_out files, but for what gltf_packing.h and gltf_out.h say of it.
///
/// Part     the nodes that belong to it, with their meshes, materials, pictures and arrays, and of their ancestors the
///          names and transforms. All numbers are new; nothing is in a file that it does not use.
/// Common   everything else of the scene: nodes without mesh, cameras, lamps, the sky, meshes that no part owns, and what moves:
///          animations with their targets, skins with their joints, and all that hangs on them.
/// Pictures that several files use are written once, beside them; others are inside. Other scenes are left out.
/// Threads  pure; the same model gives the same bytes.
#pragma once
#include <filesystem>
#include <vector>

#include "formats/gltf/gltf_out.h"
#include "formats/gltf/gltf_out_files.h"

namespace luxel {

/// `model` has been written by `files` at `path`; its pictures may get other places here. `page_images`: the image of each
/// lightmap page. When something fails, the files that this call has written are removed.
GltfParts write_parts(const std::filesystem::path& path, OutputModel& model, const ModelFiles& files, const GltfPacking& packing,
                      const std::vector<std::uint64_t>& page_images);

}  // namespace luxel
