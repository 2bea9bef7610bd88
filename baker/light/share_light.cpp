#include "baker/light/share_light.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <unordered_map>

#include "baker/core/parallel.h"
#include "baker/core/sobol.h"
#include "baker/light/texel_window.h"

namespace luxel {
namespace {

constexpr std::size_t disc_count = TexelWindow::disc_count;
constexpr std::size_t most_members = 197;
/// A plane is fitted to the small discs; to the large ones a quadratic, since light that bends over them would lose its peaks.
constexpr std::size_t first_quadratic = 3;
/// Noise goes with light: in the dark beside what is bright it is less. How loud it is relative to the light is pooled over the disc, but
/// over no smaller one than this: 13 texels know it to a fifth or so. How bright a disc that is smaller than this is, the median of the
/// texel and those beside it says, as one of them may be an outlier.
constexpr std::size_t smallest_noise_disc = 2;
/// No texel is taken for darker than this share of the root mean square around it: where most rays miss what few find, half of the texels are.
constexpr double least_light = 0.3;
/// Half width of the intervals in standard errors.
constexpr double confidence = 1.4;

/// Both halves of the rays, three channels each.
using Values = Eigen::Matrix<double, 1, 6>;

double luminance_of(const Values& values, std::size_t half) {
    const auto first = static_cast<Eigen::Index>(3 * half);
    return 0.2126 * values[first] + 0.7152 * values[first + 1] + 0.0722 * values[first + 2];
}

/// What a disc says of its middle: values of both halves, and the variance of each.
struct Disc {
    Values values;
    std::array<double, 2> variance{0, 0};  ///< in double: the light of 1e-30 has one too
};

/// Weights with which the values at some places give the value of a polynomial of least squares at the middle.
template <int terms>
void find_weights(std::span<const TexelWindow::Place> places, std::span<double> weights) {
    const auto basis_at = [](const TexelWindow::Place& place) {
        const double x = static_cast<double>(place.dx) / TexelWindow::most_radius, y = static_cast<double>(place.dy) / TexelWindow::most_radius;
        Eigen::Matrix<double, terms, 1> basis;
        basis[0] = 1, basis[1] = x, basis[2] = y;
        if constexpr (terms == 6) basis[3] = x * x, basis[4] = x * y, basis[5] = y * y;
        return basis;
    };
    Eigen::Matrix<double, terms, terms> moments = Eigen::Matrix<double, terms, terms>::Zero();
    for (const TexelWindow::Place& place : places) {
        const auto basis = basis_at(place);
        moments += basis * basis.transpose();
    }
    // A little stiffness: a row of texels says nothing about the slope across it.
    for (int k = 1; k < terms; ++k) moments(k, k) += 1e-4 * moments(0, 0);
    const Eigen::Matrix<double, terms, 1> of_middle = moments.ldlt().solve(Eigen::Matrix<double, terms, 1>::Unit(0));
    for (std::size_t k = 0; k < places.size(); ++k) weights[k] = of_middle.dot(basis_at(places[k]));
}

void find_weights(std::size_t disc, std::span<const TexelWindow::Place> places, std::span<double> weights) {
    if (disc < first_quadratic)
        find_weights<3>(places, weights);
    else
        find_weights<6>(places, weights);
}

/// Weights of each disc where no texel of it is missing, as most are.
const std::array<std::vector<double>, disc_count>& whole_weights() {
    static const std::array<std::vector<double>, disc_count> all = [] {
        std::array<std::vector<double>, disc_count> made;
        for (std::size_t disc = 0; disc < disc_count; ++disc) {
            made[disc].resize(TexelWindow::disc_ends()[disc]);
            find_weights(disc, TexelWindow::places().first(made[disc].size()), made[disc]);
        }
        return made;
    }();
    return all;
}

/// Weights of discs with missing texels, as they are asked for: along a border, the same ones again and again.
class WeightCache {
  public:
    /// What was returned before is of no use any more.
    void next_texel() {
        if (found_.size() >= most_entries) found_.clear();
    }
    /// For all members of a window that has grown to `disc`.
    std::span<const double> weights(std::size_t disc, const TexelWindow& window) {
        if (window.members().size() == whole_weights()[disc].size()) return whole_weights()[disc];
        std::vector<double>& own = found_[{disc, window.shape()}];
        if (own.empty()) {
            std::array<TexelWindow::Place, most_members> places;
            own.resize(window.members().size());
            for (std::size_t k = 0; k < own.size(); ++k) places[k] = window.members()[k].place;
            find_weights(disc, {places.data(), own.size()}, own);
        }
        return own;
    }

  private:
    static constexpr std::size_t most_entries = 2048;
    struct Key {
        std::size_t disc;
        TexelWindow::Shape shape;
        bool operator==(const Key&) const = default;
    };
    struct Hash {
        std::size_t operator()(const Key& key) const {
            std::uint64_t hash = key.disc;
            for (const std::uint64_t word : key.shape) hash = mix(hash, word);
            return hash;
        }
    };
    std::unordered_map<Key, std::vector<double>, Hash> found_;
};

/// The rule of intersecting intervals for one half: which disc is the largest that agrees with all smaller ones.
class Intervals {
  public:
    /// A disc's value and standard error. From the first that disagrees on, none is taken.
    void add(double value, double error) {
        // A larger disc that reaches into louder surroundings knows less.
        if (agreeing_ > 0 && !(error < last_error_)) ended_ = true;
        last_error_ = error;
        low_ = std::max(low_, value - confidence * error), high_ = std::min(high_, value + confidence * error);
        if (low_ > high_) ended_ = true;
        if (!ended_) ++agreeing_;
    }
    [[nodiscard]] bool ended() const { return ended_; }
    [[nodiscard]] std::size_t largest() const { return agreeing_ - 1; }

  private:
    double low_ = -std::numeric_limits<double>::max(), high_ = std::numeric_limits<double>::max();
    double last_error_ = 0;
    std::size_t agreeing_ = 0;
    bool ended_ = false;
};

class Sharer {
  public:
    Sharer(const PageTexels& page, std::uint32_t page_size, const GatheredLight& light, std::uint32_t most_texels)
        : page_(page), light_(light), grid_(page, page_size) {
        while (discs_ < disc_count && TexelWindow::disc_radii[discs_] <= static_cast<int>(most_texels)) ++discs_;
    }

    /// `bias_squares`: per texel, the square of its bias as it alone knows it, signed; lux^2.
    void share(std::uint32_t index, WeightCache& cache, SharedLight& result, std::vector<float>& bias_squares) const {
        result.irradiance[index] = (light_.halves[0][index] + light_.halves[1][index]) * 0.5f;
        if (!page_.can_send(page_.texels[index])) return;
        cache.next_texel();
        TexelWindow window(grid_, index);
        std::array<Values, most_members> values;
        std::array<std::array<double, most_members>, 2> luminances;
        double noise = 0, light_squares = 0;  // sums of the variances of halves, and of their squares
        const auto grow = [&](std::size_t disc) {
            const std::size_t before = window.members().size();
            const auto added = window.grow(disc);
            for (std::size_t k = 0; k < added.size(); ++k) {
                values[before + k] = values_at(added[k].texel);
                const double first = luminances[0][before + k] = luminance_of(values[before + k], 0);
                const double second = luminances[1][before + k] = luminance_of(values[before + k], 1);
                noise += (first - second) * (first - second) / 2;
                light_squares += (first * first + second * second) / 2;
            }
        };
        std::array<std::span<const double>, disc_count> weights;
        const auto grow_weighted = [&](std::size_t disc) {
            grow(disc);
            weights[disc] = cache.weights(disc, window);
        };
        for (std::size_t k = 0; k <= smallest_noise_disc; ++k) grow_weighted(k);
        const double around = std::sqrt(light_squares / static_cast<double>(window.members().size()));
        std::array<double, 2> light;  // of each half, near the texel
        for (std::size_t half = 0; half < 2; ++half)
            light[half] = std::clamp(median({luminances[half].data(), weights[1].size()}), least_light * around, around);
        std::array<Disc, disc_count> discs;
        std::array<Intervals, 2> intervals;
        for (std::size_t k = 0; k < discs_; ++k) {
            if (k > smallest_noise_disc) grow_weighted(k);
            discs[k] = disc(k, weights[k], values, luminances, light);
            const double relative = light_squares > 0 ? noise / light_squares : 0.0;
            for (std::size_t half = 0; half < 2; ++half) {
                discs[k].variance[half] *= relative;
                intervals[half].add(luminance_of(discs[k].values, half), std::sqrt(discs[k].variance[half]));
            }
            if (intervals[0].ended() && intervals[1].ended()) break;
        }
        const std::array<std::size_t, 2> largest{intervals[0].largest(), intervals[1].largest()};
        choose(discs, largest, index, result);
        bias_squares[index] = static_cast<float>(0.5 * (excess(discs, largest[1], 0) + excess(discs, largest[0], 1)));
    }

    /// Mean of `squares` over the texels around one, as a root.
    [[nodiscard]] float bias(std::uint32_t index, const std::vector<float>& squares) const {
        if (!page_.can_send(page_.texels[index])) return 0;
        TexelWindow window(grid_, index);
        double sum = 0;
        for (std::size_t k = 0; k <= smallest_noise_disc; ++k)
            for (const TexelWindow::Member& member : window.grow(k)) sum += static_cast<double>(squares[member.texel]);
        return static_cast<float>(std::sqrt(std::max(sum / static_cast<double>(window.members().size()), 0.0)));
    }

  private:
    [[nodiscard]] Values values_at(std::uint32_t texel) const {
        const Rgb &a = light_.halves[0][texel], &b = light_.halves[1][texel];
        Values values;
        values << static_cast<double>(a.x), static_cast<double>(a.y), static_cast<double>(a.z), static_cast<double>(b.x),
            static_cast<double>(b.y), static_cast<double>(b.z);
        return values;
    }

    static double median(std::span<const double> values) {
        std::array<double, most_members> sorted;
        std::copy(values.begin(), values.end(), sorted.begin());
        const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
        std::nth_element(sorted.begin(), middle, sorted.begin() + static_cast<std::ptrdiff_t>(values.size()));
        return *middle;
    }

    /// The fit to a disc's members; its variances are for relative noise of 1. `light`: of each half, for discs that are too small to
    /// ask each member.
    static Disc disc(std::size_t number, std::span<const double> weights, const std::array<Values, most_members>& values,
                     const std::array<std::array<double, most_members>, 2>& luminances, const std::array<double, 2>& light) {
        Disc result{Values::Zero()};
        for (std::size_t k = 0; k < weights.size(); ++k) {
            result.values += weights[k] * values[k];
            for (std::size_t half = 0; half < 2; ++half) {
                const double loud = weights[k] * (number < smallest_noise_disc ? light[half] : luminances[half][k]);
                result.variance[half] += loud * loud;
            }
        }
        return result;
    }

    /// Square of what sharing changes beyond noise, signed: no more than noise has to come out as nothing on average. A disc holds the
    /// smaller one, so what they differ by has the difference of their variances.
    static double excess(const std::array<Disc, disc_count>& discs, std::size_t chosen, std::size_t half) {
        if (chosen == 0) return 0;
        const Disc &taken = discs[chosen], &smaller = discs[chosen - 1];
        const double difference = luminance_of(taken.values, half) - luminance_of(smaller.values, half);
        return difference * difference - std::max(smaller.variance[half] - taken.variance[half], 0.0);
    }

    /// Each half takes the disc that the other has chosen: what chooses knows nothing of the noise that is averaged, so that no
    /// outlier decides about itself, and the mean stays true.
    static void choose(const std::array<Disc, disc_count>& discs, const std::array<std::size_t, 2>& largest, std::uint32_t index,
                       SharedLight& result) {
        const Disc &first = discs[largest[1]], &second = discs[largest[0]];
        for (int c = 0; c < 3; ++c)
            result.irradiance[index][c] = static_cast<float>(std::max((first.values[c] + second.values[3 + c]) * 0.5, 0.0));
        result.standard_error[index] = static_cast<float>(0.5 * std::sqrt(first.variance[0] + second.variance[1]));
    }

    const PageTexels& page_;
    const GatheredLight& light_;
    TexelGrid grid_;
    std::size_t discs_ = 0;
};

}  // namespace

SharedLight share_light(const PageTexels& page, std::uint32_t page_size, const GatheredLight& light,
                        std::uint32_t most_texels) {
    SharedLight result;
    const std::size_t count = page.texels.size();
    result.irradiance.resize(count);
    result.standard_error.assign(count, 0);
    result.bias.assign(count, 0);
    std::vector<float> bias_squares(count, 0);
    const Sharer sharer(page, page_size, light, most_texels);
    parallel_ranges(count, 4096, [&](std::size_t, std::size_t begin, std::size_t end) {
        WeightCache cache;
        for (std::size_t k = begin; k < end; ++k) sharer.share(static_cast<std::uint32_t>(k), cache, result, bias_squares);
    });
    parallel_ranges(count, 1024, [&](std::size_t, std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) result.bias[k] = sharer.bias(static_cast<std::uint32_t>(k), bias_squares);
    });
    return result;
}

}  // namespace luxel
