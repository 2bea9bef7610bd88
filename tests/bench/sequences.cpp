#include "tests/bench/sequences.h"

#include <algorithm>
#include <utility>

#include "baker/core/sobol.h"

namespace luxel::bench {
namespace {

float to_unit(std::uint32_t x) { return static_cast<float>(x >> 8) * 0x1p-24f; }
std::uint32_t hash(std::uint64_t a, std::uint64_t b) { return static_cast<std::uint32_t>(mix(a, b) >> 16); }

/// The first four Sobol dimensions, not scrambled (Joe and Kuo 2008: degree, inner coefficients, initial numbers).
std::uint32_t plain_sobol(std::size_t dimension, std::uint32_t index) {
    struct Start {
        unsigned degree, coefficients;
        std::array<std::uint32_t, 3> m;
    };
    static constexpr std::array<Start, 4> starts{{{0, 0, {}}, {1, 0, {1, 0, 0}}, {2, 1, {1, 3, 0}}, {3, 1, {1, 3, 1}}}};
    static const auto directions = [] {
        std::array<std::array<std::uint32_t, 32>, 4> all{};
        for (std::size_t d = 0; d < 4; ++d)
            for (unsigned i = 0; i < 32; ++i) {
                const Start& s = starts[d];
                if (d == 0) {
                    all[d][i] = 1u << (31 - i);
                } else if (i < s.degree) {
                    all[d][i] = s.m[i] << (31 - i);
                } else {
                    all[d][i] = all[d][i - s.degree] ^ (all[d][i - s.degree] >> s.degree);
                    for (unsigned k = 1; k < s.degree; ++k)
                        if ((s.coefficients >> (s.degree - 1 - k)) & 1u) all[d][i] ^= all[d][i - k];
                }
            }
        return all;
    }();
    std::uint32_t x = 0;
    for (unsigned bit = 0; bit < 32; ++bit)
        if ((index >> bit) & 1u) x ^= directions[dimension][bit];
    return x;
}

/// Owen's scrambling word by word: every bit is flipped by a hash of the bits above it.
std::uint32_t tree_scramble(std::uint32_t x, std::uint64_t seed) {
    std::uint32_t result = 0;
    for (int bit = 31; bit >= 8; --bit) {
        const std::uint32_t above = bit == 31 ? 0 : x >> (bit + 1);
        const std::uint32_t flip = hash(mix(seed, static_cast<std::uint64_t>(bit)), above) & 1u;
        result |= (((x >> bit) & 1u) ^ flip) << bit;
    }
    return result;
}

Point4 sobol_owen(std::uint64_t seed, std::uint32_t index) { return SobolSequence(seed).point(index); }

Point4 sobol_direction_first(std::uint64_t seed, std::uint32_t index) {
    const Point4 u = sobol_owen(seed, index);
    return {u[2], u[3], u[0], u[1]};
}

Point4 sobol_crossed(std::uint64_t seed, std::uint32_t index) {
    const Point4 u = sobol_owen(seed, index);
    return {u[0], u[2], u[1], u[3]};
}

Point4 sobol_tree(std::uint64_t seed, std::uint32_t index) {
    Point4 u;
    for (std::size_t d = 0; d < 4; ++d) u[d] = to_unit(tree_scramble(plain_sobol(d, index), mix(seed, d)));
    return u;
}

Point4 sobol_shift(std::uint64_t seed, std::uint32_t index) {
    Point4 u;
    for (std::size_t d = 0; d < 4; ++d) u[d] = to_unit(plain_sobol(d, index) ^ hash(seed, d));
    return u;
}

/// Two (0, 2)-sequences, scrambled alike well, that know nothing of each other: the second one in a shuffled order
/// (its index is scrambled such that prefixes of 2^k points stay prefixes).
Point4 padded_pairs(std::uint64_t seed, std::uint32_t index) {
    const Point4 place = SobolSequence(seed).point(index);
    // A bit is flipped by a hash of the bits above it, and never while those are zero.
    std::uint32_t shuffled = 0;
    const std::uint64_t shuffle_seed = mix(seed, 77);
    for (unsigned bit = 0; bit < 24; ++bit) {
        const std::uint32_t above = index >> (bit + 1);
        const std::uint32_t flip = above ? hash(mix(shuffle_seed, bit), above) & 1u : 0u;
        shuffled |= (((index >> bit) & 1u) ^ flip) << bit;
    }
    const Point4 direction = SobolSequence(mix(seed, 78)).point(shuffled);
    return {place[0], place[1], direction[0], direction[1]};
}

/// Roberts, The Unreasonable Effectiveness of Quasirandom Sequences, 2018: multiples of the powers of 1 / phi_4, phi_4 the root
/// of x^5 = x + 1, with a random shift.
Point4 r4(std::uint64_t seed, std::uint32_t index) {
    constexpr double phi = 1.16730397826141868426;
    Point4 u;
    double step = 1;
    for (std::size_t d = 0; d < 4; ++d) {
        step /= phi;
        const double at = static_cast<double>(hash(seed, d)) * 0x1p-32 + static_cast<double>(index) * step;
        u[d] = std::min(static_cast<float>(at - static_cast<double>(static_cast<std::uint64_t>(at))), 0x1.fffffep-1f);
    }
    return u;
}

/// Halton in bases 2, 3, 5, 7 with nested (Owen's) permutations of the digits.
Point4 halton(std::uint64_t seed, std::uint32_t index) {
    constexpr std::array<std::uint32_t, 4> bases{2, 3, 5, 7};
    Point4 u;
    for (std::size_t d = 0; d < 4; ++d) {
        const std::uint32_t base = bases[d];
        double value = 0, share = 1;
        std::uint64_t above = mix(seed, d);
        std::uint32_t rest = index;
        while (share > 1e-7) {
            std::array<std::uint32_t, 7> permutation{0, 1, 2, 3, 4, 5, 6};
            for (std::uint32_t k = base - 1; k > 0; --k) std::swap(permutation[k], permutation[hash(above, k) % (k + 1)]);
            const std::uint32_t digit = rest % base;
            rest /= base;
            share /= base;
            value += share * permutation[digit];
            above = mix(above, digit + 8);
        }
        u[d] = std::min(static_cast<float>(value), 0x1.fffffep-1f);
    }
    return u;
}

Point4 independent(std::uint64_t seed, std::uint32_t index) {
    Point4 u;
    for (std::size_t d = 0; d < 4; ++d) u[d] = to_unit(hash(mix(seed, index), d));
    return u;
}

}  // namespace

std::vector<Sequence> sequences() {
    return {{"Sobol, Owen by hash", sobol_owen},
            {"Sobol, Owen by tree", sobol_tree},
            {"  direction first", sobol_direction_first},
            {"  pairs crossed", sobol_crossed},
            {"Sobol, random shift", sobol_shift},
            {"two 2-D Sobol pairs", padded_pairs},
            {"Halton, scrambled", halton},
            {"R4, random shift", r4},
            {"independent", independent}};
}

}  // namespace luxel::bench
