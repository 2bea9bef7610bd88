/// Draco's decoder within bounds. Draco believes what a stream says of itself: some hundred bytes may claim 2^31
/// triangles, for which it takes gigabytes, or as many bits of one prediction, over which it counts for ten seconds. Here
/// the counts are compared with the size of the stream, and with each other, before anything is taken or counted.
///
/// Bounds   Triangles, each once more for every attribute with seams of its own, and points: 64 for each byte of the
///          stream and 2^22 besides. Draco at its default effort spends at least a quarter of a byte on a triangle; at
///          its highest it gets a flat, regular sheet of 2^19 triangles with texture coordinates down to 1/157 byte.
///          Such sheets are what the 2^22 are for.
///          Decoded attributes: 1024 bytes for each byte of the stream and 2^27 besides (the same sheet: 39 a byte at
///          default effort, 1600 at the highest).
///          Orientations of texture coordinates: three a triangle, one for each corner, which is all that is ever read.
///          So time and memory follow the size of the file, and are the same on every machine.
/// Errors   Error{bad_input} with `where`: beyond the bounds, or refused by Draco.
/// Threads  pure.
/// Source   Draco bitstream specification 2.2. The checks are made where classes of Draco let themselves be derived
///          from; no stream is decoded by code of ours.
#pragma once
#include <draco/mesh/mesh.h>

#include <memory>
#include <string>

#include "formats/base/bytes.h"

namespace luxel {

/// What draco::Decoder::DecodeMeshFromBuffer() makes of the stream.
std::unique_ptr<draco::Mesh> decode_draco_mesh(ByteView stream, const std::string& where);

}  // namespace luxel
