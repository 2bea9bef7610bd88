/// How the arrays of a written model are stored: plain, Draco, meshopt, or Draco for what it can and meshopt for the rest.
///
/// Errors   Error{usage} naming the part of a text that is wrong.
/// Threads  pure.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace luxel {

/// Bits that Draco keeps of each component of arrays of floats, 1 .. 24 (normals 2 .. 24), as floats have no more. Integers are always kept exactly.
struct DracoBits {
    int position = 14;  ///< over the largest extent of the whole mesh, so that its primitives still meet
    int normal = 10;    ///< of each of two numbers that tell the direction
    int texcoord = 12;  ///< over one repeat of the texture; sets that cover more get more bits
    int color = 8;
    int lightmap = 0;   ///< of TEXCOORD_1, over the page; 0: so many that the error is below 1/32 texel
    int other = 12;     ///< tangents, weights, custom attributes: over the range of their values
};

/// "POSITION=14,LIGHTMAP=auto": any of POSITION, NORMAL, TEXCOORD, COLOR, LIGHTMAP, OTHER; what is not named keeps its default.
DracoBits parse_draco_bits(const std::string& list, const std::string& where);
/// All six, as the parser takes them.
std::string draco_bits_text(const DracoBits& bits);
/// The bits of TEXCOORD_1 for pages of this side: DracoBits::lightmap, or chosen: ceil(log2 side) + 5, which leaves
/// errors of at most half a step of 1/32 texel.
int lightmap_bits(const DracoBits& bits, std::uint32_t page_size);

/// Which nodes go into files of their own, beside the whole model (gltf_out_parts.h).
struct GltfSplit {
    std::vector<std::int64_t> part_of_node;  ///< per node of the input: number of its part, or -1: common
    std::size_t part_count = 0;
    std::int64_t scene = -1;  ///< of the input: the one that is split; -1: the default
};

struct GltfPacking {
    std::optional<DracoBits> draco{};  ///< KHR_draco_mesh_compression for triangles
    bool meshopt = false;              ///< EXT_meshopt_compression for every array that is left and fits
    std::uint32_t page_size = 1024;    ///< texels along a lightmap page
    std::optional<GltfSplit> split{};
};

}  // namespace luxel
