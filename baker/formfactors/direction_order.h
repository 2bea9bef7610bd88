/// An order of rays in which neighbours look the same way: packets of such rays walk the same branches of the tree, and
/// their hits lie side by side in memory.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>

namespace luxel {

constexpr std::size_t most_ordered_directions = 4096;

/// Writes the numbers 0 to u.size() - 1 to `order`, so that the points (u, v) of the unit square that they stand for
/// follow Hilbert's curve through cells of about one point each; within a cell the lower number comes first. The
/// square's map onto the hemisphere keeps neighbours together (core/sampling.h). Equal sizes, at most `most_ordered_directions`. Threads:
/// pure function. Errors: none. Source: Hilbert, Ueber die stetige Abbildung einer Linie auf ein Flaechenstueck, Math.
/// Annalen 38 (1891).
void order_by_direction(std::span<const float> u, std::span<const float> v, std::span<std::uint16_t> order);

}  // namespace luxel
