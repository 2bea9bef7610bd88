#include "baker/formfactors/hemicube_weights.h"

#include <array>
#include <cmath>
#include <span>

#include "baker/core/units.h"
#include "formats/base/error.h"

namespace luxel {
namespace {

constexpr std::array<double, 3> gauss_node{-0.77459666924148337704, 0, 0.77459666924148337704};
constexpr std::array<double, 3> gauss_weight{5.0 / 18, 8.0 / 18, 5.0 / 18};

/// Integral over the square pixel of side `size` around (x, y). Top: height is 1; a side has its z in `y`.
double pixel_integral(bool top, double x, double y, double size) {
    double sum = 0;
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) {
            const double s = x + size / 2 * gauss_node[i], t = y + size / 2 * gauss_node[j];
            const double squared = s * s + t * t + 1;
            sum += gauss_weight[i] * gauss_weight[j] * (top ? 1 : t) / (squared * squared);
        }
    return sum * size * size / pi;
}

/// Whole numbers in proportion to `shares`, with exactly this sum; each is where the running sum is rounded to.
std::vector<std::uint32_t> in_fixed_point(std::span<const double> shares, std::uint64_t sum) {
    double total = 0;
    for (const double share : shares) total += share;
    std::vector<std::uint32_t> whole;
    whole.reserve(shares.size());
    double running = 0;
    std::uint64_t given = 0;
    for (std::size_t k = 0; k < shares.size(); ++k) {
        running += shares[k];
        const auto reached = k + 1 == shares.size()
                                 ? sum
                                 : std::min(sum, static_cast<std::uint64_t>(running / total * static_cast<double>(sum) + 0.5));
        whole.push_back(static_cast<std::uint32_t>(reached - given));
        given = reached;
    }
    return whole;
}

}  // namespace

HemicubeWeights::HemicubeWeights(std::uint32_t resolution) : resolution_(resolution) {
    if (resolution < 2 || resolution > 4096 || resolution % 2)
        throw Error(ErrorCode::usage, "hemicube resolution", "expected an even number from 2 to 4096, found " + std::to_string(resolution));
    const double size = 2.0 / resolution;
    std::vector<double> top, side;
    for (std::uint32_t row = 0; row < resolution; ++row)
        for (std::uint32_t column = 0; column < resolution; ++column) {
            const double x = (column + 0.5) * size - 1;
            top.push_back(pixel_integral(true, x, (row + 0.5) * size - 1, size));
            if (row < resolution / 2) side.push_back(pixel_integral(false, x, 1 - (row + 0.5) * size, size));
        }
    double top_share = 0, side_share = 0;
    for (const double share : top) top_share += share;
    for (const double share : side) side_share += share;
    constexpr std::uint64_t whole = std::uint64_t{1} << hemicube_level;
    const auto side_sum = static_cast<std::uint64_t>(side_share / (top_share + 4 * side_share) * static_cast<double>(whole) + 0.5);
    top_ = in_fixed_point(top, whole - 4 * side_sum);
    side_ = in_fixed_point(side, side_sum);
}

Vec3f HemicubeWeights::direction(std::uint32_t face, std::uint32_t row, std::uint32_t column) const {
    const float size = 2.0f / static_cast<float>(resolution_);
    const float s = (static_cast<float>(column) + 0.5f) * size - 1, t = (static_cast<float>(row) + 0.5f) * size;
    switch (face) {
        case 0: return {s, t - 1, 1};
        case 1: return {1, s, 1 - t};
        case 2: return {-s, 1, 1 - t};
        case 3: return {-1, -s, 1 - t};
        default: return {s, -1, 1 - t};
    }
}

}  // namespace luxel
