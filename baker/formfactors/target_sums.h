/// Counts by target, added up in any order and listed in ascending order of targets.
#pragma once
#include <bit>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace luxel {

/// Targets are numbers below a bound of some thousands: whether one was met is a bit of its own, so that adding is free
/// of choices, and listing looks at all bits. Memory: 33 bits a target.
class TargetSums {
  public:
    explicit TargetSums(std::size_t bound) : sums_(bound), met_((bound + 63) / 64) {}
    /// count > 0; sums are modulo 2^32.
    void add(std::size_t target, std::uint32_t count) {
        met_[target / 64] |= std::uint64_t{1} << (target % 64);
        sums_[target] += count;
    }
    /// Calls body(target, sum) for each target that was met, ascending, and forgets them.
    template <class Body>
    void drain(Body&& body) {
        for (std::size_t at = 0; at < met_.size(); ++at)
            for (std::uint64_t word = std::exchange(met_[at], 0); word; word &= word - 1) {
                const std::size_t target = at * 64 + static_cast<std::size_t>(std::countr_zero(word));
                body(static_cast<std::uint32_t>(target), std::exchange(sums_[target], 0));
            }
    }

  private:
    std::vector<std::uint32_t> sums_;
    std::vector<std::uint64_t> met_;
};

}  // namespace luxel
