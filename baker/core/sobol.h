/// Four-dimensional Owen-scrambled Sobol points: the sample pattern of every estimator.
/// Integers only, so the same on every machine; a point is a pure function of (seed, index).
/// Source: Joe and Kuo, Constructing Sobol sequences with better two-dimensional projections, SIAM J. Sci. Comput. 30
/// (2008), dimensions 1 to 4; Burley, Practical Hash-based Owen Scrambling, JCGT 9(4) 2020 (Laine-Karras permutation).
#pragma once
#include <array>
#include <cstdint>

namespace luxel {

/// Well-mixed 64-bit hash of two numbers (finaliser of SplitMix64, Steele et al. 2014).
constexpr std::uint64_t mix(std::uint64_t a, std::uint64_t b = 0) {
    std::uint64_t z = a + 0x9e3779b97f4a7c15ULL * (b + 1);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
    return z ^ (z >> 31);
}

/// A scrambled sequence. The first 2^k points of a sequence are a (0, k, 2)-net in dimensions 0 and 1, and the four
/// dimensions together are stratified as Sobol's are. Points are in [0, 1) with 24 bits.
class SobolSequence {
  public:
    explicit SobolSequence(std::uint64_t seed);
    [[nodiscard]] std::array<float, 4> point(std::uint32_t index) const;

    /// Points [begin, begin + batch) at once, dimension by dimension: the same numbers as point(), several times faster.
    /// `begin` is a multiple of `batch`.
    static constexpr std::uint32_t batch = 64;
    void points(std::uint32_t begin, std::array<std::array<float, batch>, 4>& out) const;

  private:
    std::array<std::uint32_t, 4> dimension_seed_;
};

/// A scrambled sequence in an order of its own: further dimensions for points whose first ones are another sequence's. Scrambling
/// keeps what points with near indexes have in common, so two sequences in the same order visit the same small part of
/// all pairs again and again, and what they estimate together does not converge however many points there are.
/// The first 2^k points, each aligned run of as many too, are stratified as those of SobolSequence.
/// Source: Burley, Practical Hash-based Owen Scrambling, JCGT 9(4) 2020 (shuffled scrambled Sobol points); Vegdahl, Building a Better LK
/// Hash, 2021 (the permutation).
class ShuffledSobol {
  public:
    /// Points of one index, of sequences with other seeds, are independent.
    explicit ShuffledSobol(std::uint64_t seed);
    [[nodiscard]] std::array<float, 4> point(std::uint32_t index) const;

  private:
    SobolSequence sequence_;
    std::uint32_t order_seed_;
};

}  // namespace luxel
