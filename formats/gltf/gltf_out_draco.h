/// Compresses the triangles of a model by Draco (KHR_draco_mesh_compression). Private to the gltf_out files.
///
/// Taken    primitives of triangles, those with a lightmap and those as the input had them. Their accessors become a
///          promise of what the stream holds: count, and min and max of the decoded numbers. Primitives with the same arrays share one
///          stream. What is Draco in the input already stays as it is.
/// Order    Edgebreaker: vertices and triangles change their order, equal vertices become one, triangles with two
///          corners at one place go. With morph targets, which stay outside of the stream, the order is kept instead.
/// Grid     positions of all primitives of a mesh lie on one grid, so that they meet where they met before.
/// Left     meshes that would not get smaller, such as single quads; points, lines, strips, fans; attributes that are matrices; what Draco refuses, with a warning.
/// Threads  pure; the same model gives the same bytes.
#pragma once
#include "formats/gltf/gltf_out_model.h"
#include "formats/gltf/gltf_out_prune.h"
#include "formats/gltf/gltf_packing.h"

namespace luxel {

/// Adds to `replaced` the arrays that compressed primitives no longer need.
void compress_draco(OutputModel& model, const DracoBits& bits, std::uint32_t page_size, ArrayReferences& replaced);

}  // namespace luxel
