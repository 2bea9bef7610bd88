/// What an error of an exchange area costs the result, with all bounces.
///
/// An error dG_ij brings wrong light dG_ij (B_j - K_i) to patch i and dG_ij (B_i - K_j) to j: closure makes up for it in the
/// rest of the row, which has the mean K (row_mean.h). With x = (A / rho - G)^-1 y, the change of
/// sum_i y_i B_i is dG_ij (x_i (B_j - K_i) + x_j (B_i - K_j)). Take y_i = sqrt(A_i) z_i with random signs z: the mean over z of
/// the square of sum_i y_i dB_i is sum_i A_i dB_i^2, the area-weighted squared error. So the cost of a pair, per squared
/// m2 of error of its exchange area, is the mean over a few z of (x_i (B_j - K_i) + x_j (B_i - K_j))^2, summed over the
/// channels (the randomised estimate of a trace: Hutchinson, Commun. Stat. Simul. 18(3), 1989). Unlike the cost of one bounce it
/// knows that light in a white room, or behind a door, is one light, whose error all patches share. Derived here.
#pragma once
#include <array>
#include <vector>

#include "baker/accuracy/pattern_solve.h"

namespace luxel {

class Sensitivity {
  public:
    /// Solves pattern_count patterns for each channel that is lit; equal channels are solved once. `light` must outlive this.
    /// Memory: 40 bytes per patch and channel. Threads: uses them all; the result does not depend on their number.
    Sensitivity(BlockSource& source, const LightState& light);

    /// Mean squared change per squared m2 of error of G_ij. Threads: reentrant.
    [[nodiscard]] double of_pair(PatchNumber i, PatchNumber j) const;
    /// The same for the area through which i sees the open, where no light comes from.
    [[nodiscard]] double of_open(PatchNumber i) const;

  private:
    struct Channel {
        std::size_t index = 0;
        double weight = 1;           ///< of how many channels this one is the image
        Patterns x;                 ///< per patch and pattern
        std::vector<double> square;  ///< sum of x^2 over the patterns
    };
    const LightState& light_;
    std::vector<Channel> channels_;
};

}  // namespace luxel
