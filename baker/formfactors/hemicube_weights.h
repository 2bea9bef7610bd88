/// The hemicube: a half cube of side 2 around a point, its pixels, and what share of a cosine hemisphere each of them stands
/// for, in fixed point. Local frame: z is the normal; the top is z = 1, the sides are x = 1, y = 1, x = -1, y = -1 with
/// 0 < z < 1.
///
/// Weights (delta form factors) are integrals over the pixel, not values at its centre, by 3 x 3 Gauss points: the
/// integrands are rational, so they are the same bits on every machine. In units of 2^-level, whole numbers whose
/// sum is 2^level exactly: the top's share takes what the four equal sides leave, and along a row of pixels the part that
/// rounding cuts off goes to the next one, so that runs of pixels are right to one unit, far below one pixel.
/// Source: Cohen and Greenberg, The Hemi-Cube: A Radiosity Solution for Complex Environments, SIGGRAPH 1985:
/// dF = dA / (pi (x2 + y2 + 1)2) on the top, z dA / (pi (y2 + z2 + 1)2) on a side.
#pragma once
#include <cstdint>
#include <vector>

#include "baker/core/vec.h"

namespace luxel {

/// Sum of all weights is 2^hemicube_level: fine enough that no pixel up to resolution 1024 is rounded by more than its own
/// alias, and pooled counts keep far from 2^32.
constexpr std::uint8_t hemicube_level = 28;

class HemicubeWeights {
  public:
    /// `resolution`: pixels along an edge of the top, even, 2 .. 4096; else Error{usage}.
    explicit HemicubeWeights(std::uint32_t resolution);

    [[nodiscard]] std::uint32_t resolution() const { return resolution_; }
    [[nodiscard]] static constexpr std::uint32_t face_count() { return 5; }
    /// Rows of pixels of a face: all of the top (face 0), half as many of a side, from the rim of the top downwards.
    [[nodiscard]] std::uint32_t rows(std::uint32_t face) const { return face == 0 ? resolution_ : resolution_ / 2; }
    /// Through the pixel's centre, local, not normalised.
    [[nodiscard]] Vec3f direction(std::uint32_t face, std::uint32_t row, std::uint32_t column) const;
    /// May be 0 for the lowest pixels of a side.
    [[nodiscard]] std::uint32_t weight(std::uint32_t face, std::uint32_t row, std::uint32_t column) const {
        return (face == 0 ? top_ : side_)[std::size_t{row} * resolution_ + column];
    }

  private:
    std::uint32_t resolution_;
    std::vector<std::uint32_t> top_, side_;  ///< row by row
};

}  // namespace luxel
