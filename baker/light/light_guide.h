/// Where the light of a patch comes from, so that rays go there: the patch's row of the matrix times the radiosity of what
/// it sees, and the open sky that it sees, gathered by direction. Cosine rays are bent towards it: a grid of equal shares of the cosine distribution (the
/// unit square under the map of core/sampling.h) gets a probability per cell, mixed with a defensive share of the plain
/// distribution, so that what the row has missed is still found and the mean depends on neither.
///
/// Directions are in a frame around the patch's normal; a texel whose shading normal leans uses the same frame, leant.
/// Source: the row as sampling density: design of this project; warping a stratified pattern by a table, cell rows first,
/// then cells: Pharr, Jakob, Humphreys, Physically Based Rendering, 3rd ed., section 13.6.7 (piecewise-constant 2D
/// distributions); defensive mixtures: Hesterberg, Weighted Average Importance Sampling and Defensive Mixture Distributions,
/// Technometrics 37(2) 1995.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "baker/formfactors/block_source.h"
#include "baker/formfactors/sky_in_view.h"
#include "baker/patches/patch.h"

namespace luxel {

/// Tables of all patches.
class LightGuides {
  public:
    static constexpr std::uint32_t side = 16, cells = side * side;

    LightGuides() = default;
    /// Reads every block twice, a chunk's row at a time. `reflected`, `emitted`: what each patch sends, >= 0, any unit; the tables are
    /// of the former. `sky`: null, or in the same unit over pi per sr. Fronts only: a back has no texels. Threads: uses them all; a pure function of the matrix, whatever its
    /// chunks: sums are of whole numbers. Throws what source and sky throw.
    LightGuides(BlockSource& source, const PatchSet& patches, std::span<const float> reflected, std::span<const float> emitted,
                const SkyInView* sky = nullptr);

    [[nodiscard]] bool empty() const { return weights_.empty(); }
    /// Relative weight of each cell for a patch, 0..255, cell x fastest; directions are in the frame around its normal.
    [[nodiscard]] std::span<const std::uint8_t, cells> of(PatchNumber patch) const {
        return std::span<const std::uint8_t, cells>(weights_.data() + std::size_t{patch} * cells, cells);
    }
    /// Share of a patch's light that comes straight from emitters, 0..1, as far as the matrix knows.
    [[nodiscard]] float emitted_share(PatchNumber patch) const { return emitted_share_[patch]; }

  private:
    std::vector<std::uint8_t> weights_;
    std::vector<float> emitted_share_;
};

/// The pattern of one texel's rays: bends points of the unit square towards the bright cells.
class GuideWarp {
  public:
    /// Share of rays that go by the guide where the light is all in few cells; the rest keeps to the cosine.
    static constexpr float most_guided = 0.75f;

    /// The plain cosine distribution.
    GuideWarp() = default;
    explicit GuideWarp(std::span<const std::uint8_t, LightGuides::cells> weights);

    struct Point {
        float u = 0, v = 0;
        float density = 1;  ///< relative to the cosine distribution's own, > 0
    };
    /// For u, v in [0, 1).
    [[nodiscard]] Point bend(float u, float v) const;
    /// Density of bend() at a unit direction of the local frame, z > 0, relative to the cosine distribution's.
    [[nodiscard]] float density(const Vec3f& local) const;

  private:
    bool is_plain_ = true;
    std::array<float, LightGuides::side + 1> row_up_to_{};                ///< cumulative over rows, [0] = 0, last 1
    std::array<float, LightGuides::cells + LightGuides::side> up_to_{};   ///< per row side + 1 entries, cumulative in the row
};

/// Frame around `normal` whose tangent keeps to that of the frame around the patch's normal.
Frame guide_frame(const Frame& patch, const Vec3f& normal);

}  // namespace luxel
