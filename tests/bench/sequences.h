/// Sample sequences in four dimensions, to be compared: each point is a pure function of (seed, index).
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace luxel::bench {

using Point4 = std::array<float, 4>;  ///< in [0, 1): place on the patch (0, 1), direction (2, 3)

struct Sequence {
    std::string name;
    std::function<Point4(std::uint64_t seed, std::uint32_t index)> point;
};

/// The sequence that the ray estimator uses is the first.
std::vector<Sequence> sequences();

}  // namespace luxel::bench
