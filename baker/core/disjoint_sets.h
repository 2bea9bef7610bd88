/// Which of n things are connected: union-find with path halving. A set is named by its smallest member, whatever the order of
/// the unions. Source: Tarjan and van Leeuwen, J. ACM 31(2) 1984. Memory: 4 bytes per thing. Threads: one at a time.
#pragma once
#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

namespace luxel {

class DisjointSets {
  public:
    explicit DisjointSets(std::uint32_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0u); }

    /// The smallest member of the set that `thing` is in.
    [[nodiscard]] std::uint32_t find(std::uint32_t thing) {
        while (parent_[thing] != thing) thing = parent_[thing] = parent_[parent_[thing]];
        return thing;
    }
    void unite(std::uint32_t one, std::uint32_t other) {
        const std::uint32_t a = find(one), b = find(other);
        parent_[std::max(a, b)] = std::min(a, b);
    }

  private:
    std::vector<std::uint32_t> parent_;
};

}  // namespace luxel
