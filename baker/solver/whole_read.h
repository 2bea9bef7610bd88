/// One pass over the blocks: y = G x for all patches at once.
#pragma once
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "baker/solver/coarse_space.h"
#include "baker/solver/transport.h"

namespace luxel {

/// x of a chunk, one entry per patch of it.
using ChunkVector = std::function<std::vector<Lanes>(ChunkNumber chunk)>;
/// Called once per block with x of its chunk a and what a's rows gathered through this block; from any thread.
using BlockSeen = std::function<void(std::size_t block_index, std::span<const Lanes> x_a, std::span<const Lanes> y_a)>;

/// Returns sum over patches j of other chunks of G_ij x_j, per patch i. `seen` may be empty. Both functions are called
/// concurrently. Memory: 32 bytes per patch and those of transport_batch_blocks pairs of chunks. The result does not
/// depend on the number of threads. Throws what the source's load() throws.
std::vector<Lanes> exchange_between_chunks(Transport& transport, const ChunkVector& x, const BlockSeen& seen);

/// The same over all blocks, those of one chunk with itself too: sum over all j != i of G_ij x_j. `x`: one entry per
/// patch.
std::vector<Lanes> exchange_everywhere(Transport& transport, std::span<const Lanes> x);

/// The same; on the way every chunk gives its even light (coarse_vectors.h) to `space`, which is empty before, unless
/// that would be more than CoarseSpace::most_entries().
std::vector<Lanes> exchange_and_columns(Transport& transport, std::span<const Lanes> x, CoarseSpace& space);

}  // namespace luxel
