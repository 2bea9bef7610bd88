/// Cuts an object into pieces of bounded size, so that the time to unwrap it grows linearly.
/// Pure and deterministic.
#pragma once
#include <cstdint>
#include <vector>

#include "baker/unwrap/object_mesh.h"

namespace luxel {

/// Lists of triangles, each at most `limit` long and ascending; together every triangle once. Parts that hang together
/// (through shared vertices) and fit stay whole, small ones share a piece; larger ones are halved along their longest
/// axis until they fit.
std::vector<std::vector<std::uint32_t>> cut_pieces(const ObjectMesh& mesh, std::size_t limit);

}  // namespace luxel
