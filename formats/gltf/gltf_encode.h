/// Encoders of the two geometry codecs of glTF; the decoders are in gltf_compression.h. No other file but that one
/// knows the two libraries.
///
/// Errors   Error{bad_input} naming `where`: Draco cannot encode a mesh (numbers that are not finite, integers of 32
///          bits, all triangles without area). Callers then leave it as it is.
/// Threads  pure functions; the same arguments give the same bytes.
/// Source   KHR_draco_mesh_compression (bitstream 2.2); EXT_meshopt_compression (bitstream version 0 of vertices, 1 of
///          indices).
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "formats/gltf/gltf_accessor.h"

namespace luxel {

/// Floats have no more. The library would take 30, but counts in tables of 8 bytes * 2^bits, whatever the size of a mesh.
constexpr int most_draco_bits = 24;

/// Steps of a quantised array: `range` / (2^bits - 1) from `origin` on, the same for all components.
struct QuantisationGrid {
    std::array<float, 4> origin{};
    float range = 1;  ///< > 0; all values of component c lie in origin[c] .. origin[c] + range
};

struct DracoInput {
    std::string semantic;    ///< POSITION, NORMAL, TEXCOORD_0 ...: decides how values are predicted
    AccessorBytes elements;  ///< SCALAR to VEC4
    int bits = 0;            ///< of each component where that is float, 1 .. most_draco_bits; integers are always kept exactly
    std::optional<QuantisationGrid> grid{};  ///< absent: as large as the values need
};

/// `in_order` keeps vertices and triangles as they are, at the price of more bytes; otherwise equal vertices become
/// one, and the order is the codec's (Edgebreaker), without triangles that have two corners at one place.
enum class DracoOrder { free, in_order };

struct DracoStream {
    Bytes bytes;
    std::vector<std::uint32_t> unique_ids;  ///< per attribute of the input
    std::uint64_t vertex_count = 0;         ///< that a decoder finds
};

/// `indices`: 3 per triangle, below the number of elements, which all attributes have in common.
DracoStream encode_draco(std::span<const DracoInput> attributes, std::span<const std::uint32_t> indices,
                         DracoOrder order, const std::string& where);

/// `bytes`: elements of `stride` bytes, a multiple of 4 up to 256, one after the other. Decoding gives the same bytes.
Bytes encode_meshopt_vertices(ByteView bytes, std::size_t stride);
/// Three per triangle. Decoding gives the same triangles in the same order; which corner comes first may differ.
Bytes encode_meshopt_triangles(std::span<const std::uint32_t> indices);
/// Any list of indices. Decoding gives the same numbers.
Bytes encode_meshopt_sequence(std::span<const std::uint32_t> indices);

}  // namespace luxel
