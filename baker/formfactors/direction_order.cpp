#include "baker/formfactors/direction_order.h"

#include <algorithm>
#include <array>
#include <bit>

namespace luxel {
namespace {

constexpr std::uint32_t most_bits = 5, side = 1u << most_bits;

/// Place on Hilbert's curve of each cell of the finest grid, row by row. Leading digits are the places on coarser
/// grids.
constexpr std::array<std::uint16_t, side * side> curve_places() {
    std::array<std::uint16_t, side * side> place{};
    for (std::uint32_t cell = 0; cell < side * side; ++cell) {
        std::uint32_t x = cell % side, y = cell / side, at = 0;
        for (std::uint32_t half = side / 2; half > 0; half /= 2) {
            const std::uint32_t right = (x & half) ? 1 : 0, top = (y & half) ? 1 : 0;
            at = 4 * at + ((3 * right) ^ top);
            if (!top) {  // the lower quarters are turned
                if (right) x = side - 1 - x, y = side - 1 - y;
                std::swap(x, y);
            }
        }
        place[cell] = static_cast<std::uint16_t>(at);
    }
    return place;
}

constexpr std::array<std::uint16_t, side* side> place_of_cell = curve_places();

std::uint32_t coordinate(float u) { return std::min(static_cast<std::uint32_t>(u * side), side - 1); }

}  // namespace

void order_by_direction(std::span<const float> u, std::span<const float> v, std::span<std::uint16_t> order) {
    // A counting sort over as many cells as there are points, or a quarter of that.
    const auto count_bits = static_cast<std::uint32_t>(std::bit_width(u.size() | 1) - 1);
    const std::uint32_t bits = std::min(most_bits, count_bits / 2), drop = 2 * (most_bits - bits);
    const std::size_t cells = std::size_t{1} << (2 * bits);
    std::array<std::uint16_t, most_ordered_directions> place;
    for (std::size_t k = 0; k < u.size(); ++k)
        place[k] = static_cast<std::uint16_t>(place_of_cell[coordinate(v[k]) * side + coordinate(u[k])] >> drop);
    std::array<std::uint16_t, side * side + 1> begin;
    std::fill_n(begin.begin(), cells + 1, std::uint16_t{0});
    for (std::size_t k = 0; k < u.size(); ++k) ++begin[place[k] + std::size_t{1}];
    for (std::size_t cell = 1; cell < cells; ++cell) begin[cell] = static_cast<std::uint16_t>(begin[cell] + begin[cell - 1]);
    for (std::size_t k = 0; k < u.size(); ++k) order[begin[place[k]]++] = static_cast<std::uint16_t>(k);
}

}  // namespace luxel
