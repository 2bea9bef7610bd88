/// Fits of gathered light over the discs of texels around one: polynomials by least squares, and how sure each is.
///
/// Noise is taken to go with light, so that dark texels beside bright ones know themselves well: how loud it is relative to light is
/// pooled over the disc.
/// Threads  a WeightCache and a DiscFits are one thread's.
/// Source   Fan and Gijbels, Local Polynomial Modelling, 1996 (local polynomials have no more bias at borders than inside).
#pragma once
#include <Eigen/Core>
#include <array>
#include <span>
#include <unordered_map>
#include <vector>

#include "baker/light/gather.h"
#include "baker/light/texel_window.h"

namespace luxel {

/// What a disc says of its middle, of each half of the rays.
struct DiscFit {
    /// Three channels of the first half, three of the second; lux.
    Eigen::Matrix<double, 1, 6> values = Eigen::Matrix<double, 1, 6>::Zero();
    std::array<double, 2> variance{0, 0};  ///< of the luminance of each half, lux^2; in double: the light of 1e-30 has one too

    [[nodiscard]] double luminance(std::size_t half) const;
};

/// Weights of the members of discs, which depend on their places only: along a border, the same ones again and again.
class WeightCache {
  public:
    /// What was returned before is of no use any more.
    void next_texel() {
        if (found_.size() >= most_entries) found_.clear();
    }
    /// For all members of a window that has grown to `disc`.
    std::span<const double> weights(std::size_t disc, const TexelWindow& window);

  private:
    static constexpr std::size_t most_entries = 2048;
    struct Key {
        std::size_t disc;
        TexelWindow::Shape shape;
        bool operator==(const Key&) const = default;
    };
    struct Hash {
        std::size_t operator()(const Key& key) const;
    };
    std::unordered_map<Key, std::vector<double>, Hash> found_;
};

/// The fits around one texel, found as they are asked for.
class DiscFits {
  public:
    /// The smallest disc whose members can tell how loud noise is: 13 texels know it to a fifth or so.
    static constexpr std::size_t smallest_noise_disc = 2;

    /// `centre`: index of a texel that light can be gathered at. Keeps references to all.
    DiscFits(const GatheredLight& light, const TexelGrid& grid, std::uint32_t centre, WeightCache& cache);
    const DiscFit& operator[](std::size_t disc);
    /// The texels of the smallest noise disc.
    [[nodiscard]] std::span<const TexelWindow::Member> neighbours() const { return window_.members().first(levels_[smallest_noise_disc].weights.size()); }
    /// Of a half, lux: the median luminance of the texel and those beside it.
    [[nodiscard]] double median_beside(std::size_t half) const { return median_beside_[half]; }

  private:
    static constexpr std::size_t most_members = 197;
    struct Level {
        std::span<const double> weights;
        double relative_noise = 0;  ///< variance of a half over the square of its light
        bool is_fitted = false;
        DiscFit fit;
    };
    void grow();
    void find_light_near();

    const GatheredLight& light_;
    WeightCache& cache_;
    TexelWindow window_;
    std::size_t grown_ = 0;  ///< discs
    std::array<Level, TexelWindow::disc_count> levels_;
    std::array<Eigen::Matrix<double, 1, 6>, most_members> values_;
    std::array<std::array<double, most_members>, 2> luminances_;
    double noise_ = 0, light_squares_ = 0;   ///< sums of the variances of halves, and of their squares
    std::array<double, 2> median_beside_{0, 0}, light_near_{0, 0};  ///< of each half
};

}  // namespace luxel
