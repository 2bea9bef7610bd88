/// Where on a piece of surface to ask for the light of a lamp that is close to it: a texel of a metre with a lamp five centimetres above it gets most of its
/// light in a hundredth of its area. The square that SurfaceSampler maps onto the piece is cut into cells, finer around the lamp, and each is asked as often as
/// it has light, were there no shadows; weights keep the mean.
///
/// Errors: none. Threads: const and reentrant; a pure function of its inputs.
/// Source: importance sampling by a function that is constant in cells; stratified as the pattern is.
#pragma once
#include <vector>

#include "baker/patches/patch_sampler.h"

namespace luxel {

class LampCells {
  public:
    /// `lamp`: its place, m, relative to Scene::origin. Keeps no reference.
    LampCells(const SurfaceSampler& sampler, const Vec3f& lamp);

    /// The lamp is too far away to make a difference: weights are 1.
    [[nodiscard]] bool is_even() const { return cells_.size() == 1; }

    struct Place {
        float u, v;    ///< of SurfaceSampler::point()
        float weight;  ///< of what is found there: the density of even places over that of these; at most 1 / even_share
    };
    /// For a and b uniform in [0, 1).
    [[nodiscard]] Place place(float a, float b) const;

    /// Of all places, those that do not care for the lamp: what the cells misjudge stays bounded.
    static constexpr double even_share = 0.1;

  private:
    struct Cell {
        float u, v, side;
        float distance_m, extent_m;  ///< of its middle from the lamp; of its corners from its middle
        double light;                ///< about, in any unit
        double up_to = 0;            ///< cumulative share of places
    };
    static Cell cell(const SurfaceSampler& sampler, const Vec3f& lamp, float u, float v, float side);

    std::vector<Cell> cells_;
};

}  // namespace luxel
