/// Sorts packed pairs by block, row, column in linear time.
#pragma once
#include <vector>

#include "baker/store/buckets.h"

namespace luxel {

/// Ascending by everything but the count (pairs of one place stay in their order). Chunk numbers are below `chunk_bound`,
/// rows and columns below `side_bound`. Memory: a second array of the same size while it runs.
void sort_pairs(std::vector<PackedPair>& pairs, std::uint32_t chunk_bound, std::uint32_t side_bound);

}  // namespace luxel
