#include "baker/core/sobol.h"

namespace luxel {
namespace {

using DirectionNumbers = std::array<std::uint32_t, 32>;

/// Direction numbers of one dimension from its primitive polynomial (degree, inner coefficients) and initial numbers m.
constexpr DirectionNumbers direction_numbers(unsigned degree, unsigned coefficients, std::array<std::uint32_t, 3> m) {
    DirectionNumbers v{};
    for (unsigned i = 0; i < 32; ++i) {
        if (i < degree) {
            v[i] = m[i] << (31 - i);
        } else {
            v[i] = v[i - degree] ^ (v[i - degree] >> degree);
            for (unsigned k = 1; k < degree; ++k)
                if ((coefficients >> (degree - 1 - k)) & 1u) v[i] ^= v[i - k];
        }
    }
    return v;
}

constexpr DirectionNumbers van_der_corput() {
    DirectionNumbers v{};
    for (unsigned i = 0; i < 32; ++i) v[i] = 1u << (31 - i);
    return v;
}

/// The four dimensions, tabulated per byte of the index: four look-ups instead of up to 32 exclusive ors.
struct ByteTables {
    std::array<std::array<std::array<std::uint32_t, 256>, 4>, 4> value{};
    constexpr ByteTables() {
        const std::array<DirectionNumbers, 4> directions{van_der_corput(), direction_numbers(1, 0, {1, 0, 0}),
                                                         direction_numbers(2, 1, {1, 3, 0}),
                                                         direction_numbers(3, 1, {1, 3, 1})};
        for (unsigned dimension = 0; dimension < 4; ++dimension)
            for (unsigned byte = 0; byte < 4; ++byte)
                for (unsigned number = 0; number < 256; ++number) {
                    std::uint32_t x = 0;
                    for (unsigned bit = 0; bit < 8; ++bit)
                        if ((number >> bit) & 1u) x ^= directions[dimension][byte * 8 + bit];
                    value[dimension][byte][number] = x;
                }
    }
};
constexpr ByteTables tables;

constexpr std::uint32_t reverse_bits(std::uint32_t x) {
    x = ((x >> 1) & 0x55555555u) | ((x & 0x55555555u) << 1);
    x = ((x >> 2) & 0x33333333u) | ((x & 0x33333333u) << 2);
    x = ((x >> 4) & 0x0f0f0f0fu) | ((x & 0x0f0f0f0fu) << 4);
    return __builtin_bswap32(x);
}

/// Permutes bits so that each depends only on lower ones (Laine-Karras form; constants of Burley 2020, section 4).
constexpr std::uint32_t laine_karras(std::uint32_t x, std::uint32_t seed) {
    x += seed;
    x ^= x * 0x6c50b47cu;
    x ^= x * 0xb82f1e52u;
    x ^= x * 0xc7afe638u;
    x ^= x * 0x8d22f6e6u;
    return x;
}

constexpr std::uint32_t owen_scramble(std::uint32_t x, std::uint32_t seed) {
    return reverse_bits(laine_karras(reverse_bits(x), seed));
}

/// As laine_karras, with less in common between near numbers: nothing but this decides which points go together (constants of Vegdahl 2021).
constexpr std::uint32_t order_hash(std::uint32_t x, std::uint32_t seed) {
    x ^= x * 0x3d20adeau;
    x += seed;
    x *= (seed >> 16) | 1u;
    x ^= x * 0x05526c56u;
    x ^= x * 0x53a22864u;
    return x;
}

std::uint32_t sobol(std::size_t dimension, std::uint32_t index) {
    const auto& table = tables.value[dimension];
    return table[0][index & 0xff] ^ table[1][(index >> 8) & 0xff] ^ table[2][(index >> 16) & 0xff] ^ table[3][index >> 24];
}

/// The upper 24 bits as a number in [0, 1).
float to_unit(std::uint32_t x) { return static_cast<float>(static_cast<std::int32_t>(x >> 8)) * 0x1p-24f; }

}  // namespace

SobolSequence::SobolSequence(std::uint64_t seed) {
    for (std::uint64_t d = 0; d < 4; ++d) dimension_seed_[d] = static_cast<std::uint32_t>(mix(seed, d));
}

std::array<float, 4> SobolSequence::point(std::uint32_t index) const {
    // No shuffling of the index: rays are added level by level, and each prefix of 2^k points must stay a net.
    std::array<float, 4> u;
    for (std::size_t d = 0; d < 4; ++d) u[d] = to_unit(owen_scramble(sobol(d, index), dimension_seed_[d]));
    return u;
}

void SobolSequence::points(std::uint32_t begin, std::array<std::array<float, batch>, 4>& out) const {
    for (std::size_t d = 0; d < 4; ++d) {
        // Sobol points are linear in the bits of the index: the low bits' share is the same for every batch.
        const std::uint32_t high = sobol(d, begin), seed = dimension_seed_[d];
        const auto& low = tables.value[d][0];
        for (std::uint32_t k = 0; k < batch; ++k) out[d][k] = to_unit(owen_scramble(high ^ low[k], seed));
    }
}

// Any number apart from those of the dimensions.
ShuffledSobol::ShuffledSobol(std::uint64_t seed) : sequence_(seed), order_seed_(static_cast<std::uint32_t>(mix(seed, 0x6f72646572))) {}

std::array<float, 4> ShuffledSobol::point(std::uint32_t index) const {
    // Scrambled as a number: runs of 2^k indexes that begin at a multiple of 2^k stay such runs.
    return sequence_.point(reverse_bits(order_hash(reverse_bits(index), order_seed_)));
}

}  // namespace luxel
