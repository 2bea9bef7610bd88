/// Multiplying one decoded block of exchange areas with vectors over patches: the inner loops of every solver.
///
/// Vectors are arrays of Lanes, one per patch of a chunk: three channels and a spare lane, 32 bytes, so that one pair
/// is one vector instruction each way. The spare lane is multiplied like the others: put 0 there, or 1 to get row sums.
/// Sizes: arrays of a have block.row_begin.size() - 1 entries; every column is below the size of b's arrays.
/// Results are added to y. Threads: pure functions; two calls may not share a y. The order of the sums is fixed.
#pragma once
#include <cstddef>
#include <span>

#include "baker/formfactors/block_source.h"

namespace luxel {

/// Channels 0..2 and the spare lane 3.
struct alignas(32) Lanes {
    double v[4] = {0, 0, 0, 0};
};

/// y_a[r] += sum over the row of G * x_b[column]: rows of a gather from b.
void gather_rows(const Block& block, std::span<const Lanes> x_b, std::span<Lanes> y_a);

/// y_b[column] += G * x_a[r]: rows of b gather from a.
void scatter_columns(const Block& block, std::span<const Lanes> x_a, std::span<Lanes> y_b);

/// Both of the above in one pass, for a != b.
void apply_both(const Block& block, std::span<const Lanes> x_a, std::span<const Lanes> x_b, std::span<Lanes> y_a,
                std::span<Lanes> y_b);

/// The same for a block with a == b, both directions, restricted to rows [row_first, row_last): parts with a y of their
/// own may run at the same time. The diagonal G_ii is not part of a block.
void apply_diagonal(const Block& block, std::size_t row_first, std::size_t row_last, std::span<const Lanes> x,
                    std::span<Lanes> y);

}  // namespace luxel
