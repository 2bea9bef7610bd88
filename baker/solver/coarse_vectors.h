/// Light that a chunk may have to send: the vectors that its part of the coarse space begins with.
#pragma once
#include <span>
#include <vector>

#include "baker/solver/chunk_system.h"
#include "baker/solver/transport.h"

namespace luxel {

/// What even light from outside becomes inside the chunk, as radiosity: rho' s with s = 1 + T_kk s. Spare lanes 0, here
/// and below.
std::vector<Lanes> even_light(const Transport& transport, const ChunkSystem& system);

/// The same of each part of the chunk by itself, at most four: the largest sets of reflecting patches that are
/// connected by pairs of `diagonal` (null: none), so that no light is guessed in a closed room because it shares a
/// chunk with a lit one.
std::vector<std::vector<Lanes>> even_light_of_parts(const Transport& transport, const ChunkSystem& system,
                                                    const Block* diagonal);

/// What the light of neighbours becomes inside the chunk: of each of the `most` - 1 neighbours that send most if all
/// surface is equally bright, and of all others together. Reads the row but for the diagonal block. Empty patterns are
/// left out.
std::vector<std::vector<Lanes>> neighbour_light(Transport& transport, const ChunkSystem& system, std::size_t most);

}  // namespace luxel
