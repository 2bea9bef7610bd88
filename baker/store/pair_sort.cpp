#include "baker/store/pair_sort.h"

#include <algorithm>
#include <array>
#include <bit>

namespace luxel {
namespace {

constexpr int digit_bits = 11;  // a table of 2048 counters stays in the first cache

/// One stable pass over the bits [shift, shift + width).
void counting_pass(const std::vector<PackedPair>& from, std::vector<PackedPair>& to, int shift, int width) {
    const PackedPair mask = (PackedPair{1} << width) - 1;
    std::array<std::size_t, std::size_t{1} << digit_bits> next{};
    for (const PackedPair pair : from) ++next[(pair >> shift) & mask];
    std::size_t sum = 0;
    for (std::size_t& begin : next) {
        const std::size_t count = begin;
        begin = sum;
        sum += count;
    }
    for (const PackedPair pair : from) to[next[(pair >> shift) & mask]++] = pair;
}

}  // namespace

void sort_pairs(std::vector<PackedPair>& pairs, std::uint32_t chunk_bound, std::uint32_t side_bound) {
    const int side_width = std::bit_width(std::max(side_bound, 2u) - 1), chunk_width = std::bit_width(std::max(chunk_bound, 2u) - 1);
    struct Field {
        int shift, width;
    };
    std::vector<PackedPair> other(pairs.size());
    for (const Field field : {Field{16, side_width}, Field{32, side_width}, Field{48, chunk_width}})
        for (int done = 0; done < field.width; done += digit_bits) {
            counting_pass(pairs, other, field.shift + done, std::min(digit_bits, field.width - done));
            pairs.swap(other);
        }
}

}  // namespace luxel
