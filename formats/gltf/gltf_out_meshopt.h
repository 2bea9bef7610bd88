/// Compresses the buffer views of a model by meshopt (EXT_meshopt_compression), without loss. Private to the gltf_out files.
///
/// Taken    views that only accessors use: vertex arrays, morph targets, animations and matrices as ATTRIBUTES, indices as
///          TRIANGLES where all of a view are whole triangles (a triangle may begin with another corner), else as INDICES.
/// Left     views with pictures, Draco data, sparse values; elements that are not a multiple of 4 bytes up to 256; indices
///          of 8 bits; views whose accessors differ in size; what would not get smaller.
/// Errors   none: a view that cannot be read is left to whoever writes it; a malformed part is a warning.
/// Threads  pure; the same model gives the same bytes.
#pragma once
#include "formats/gltf/gltf_out_model.h"

namespace luxel {

/// Numbers of accessors and views stay; to be called last, before the files are laid out.
void pack_meshopt(OutputModel& model);

}  // namespace luxel
