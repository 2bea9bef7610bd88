#include "baker/light/share_light.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "baker/core/parallel.h"
#include "baker/light/disc_fits.h"

namespace luxel {
namespace {

/// Half width of the intervals in standard errors.
constexpr double confidence = 1.4;
/// Which discs the texels around one have chosen, that one is raised to: this share of them has chosen no larger ones.
constexpr double raised_to = 0.3;
/// Half width of its intervals.
constexpr double raised_confidence = 3;

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

/// A disc for each half.
using Choice = std::array<std::uint8_t, 2>;

class Sharer {
  public:
    Sharer(const PageTexels& page, std::uint32_t page_size, const GatheredLight& light, std::uint32_t most_texels)
        : page_(page), light_(light), grid_(page, page_size), choices_(page.texels.size()), bias_(page.texels.size(), 0) {
        while (discs_ < TexelWindow::disc_count && TexelWindow::disc_radii[discs_] <= static_cast<int>(most_texels)) ++discs_;
    }

    SharedLight share() {
        SharedLight result;
        const std::size_t count = page_.texels.size();
        result.irradiance.resize(count);
        result.standard_error.assign(count, 0);
        result.bias.assign(count, 0);
        for_each_texel([&](std::uint32_t k, WeightCache& cache) { choices_[k] = choice(k, cache); });
        for_each_texel([&](std::uint32_t k, WeightCache& cache) { set_light(k, cache, result); });
        for_each_texel([&](std::uint32_t k, WeightCache&) { result.bias[k] = bias(k); });
        for (std::size_t k = 0; k < count; ++k)
            if (!page_.can_send(page_.texels[k])) result.irradiance[k] = (light_.halves[0][k] + light_.halves[1][k]) * 0.5f;
        return result;
    }

  private:
    /// Of those that light was gathered at.
    template <typename Function>
    void for_each_texel(const Function& function) const {
        parallel_ranges(page_.texels.size(), 2048, [&](std::size_t, std::size_t begin, std::size_t end) {
            WeightCache cache;
            for (std::size_t k = begin; k < end; ++k)
                if (page_.can_send(page_.texels[k])) function(static_cast<std::uint32_t>(k), cache);
        });
    }

    /// As the texel alone would choose.
    [[nodiscard]] Choice choice(std::uint32_t index, WeightCache& cache) const {
        DiscFits fits(light_, grid_, index, cache);
        std::array<Intervals, 2> intervals;
        for (std::size_t k = 0; k < discs_ && !(intervals[0].ended() && intervals[1].ended()); ++k)
            for (std::size_t half = 0; half < 2; ++half) intervals[half].add(fits[k].luminance(half), std::sqrt(fits[k].variance[half]));
        return {static_cast<std::uint8_t>(intervals[0].largest()), static_cast<std::uint8_t>(intervals[1].largest())};
    }

    /// Chance ends intervals early at one texel in ten or so: there, noise would be left that stands out from its smooth surroundings as a
    /// dot. An edge has small discs all along it, and both halves see it. What is louder further out is not let in.
    [[nodiscard]] Choice raised_choice(std::uint32_t index, DiscFits& fits) const {
        Choice raised = choices_[index];
        for (std::size_t half = 0; half < 2; ++half) {
            const std::uint8_t around = choice_around(fits.neighbours(), half), alone = raised[half];
            const auto is_far = [&](std::uint8_t disc, std::size_t by) {
                // A single texel may be an outlier by itself.
                const double own = alone == 0 ? fits.median_beside(by) : fits[alone].luminance(by);
                return std::abs(fits[disc].luminance(by) - own) > raised_confidence * std::sqrt(fits[alone].variance[by]);
            };
            for (std::uint8_t& own = raised[half]; own < around; ++own) {
                const auto next = static_cast<std::uint8_t>(own + 1);
                if (fits[next].variance[half] >= fits[own].variance[half] || (is_far(next, 0) && is_far(next, 1))) break;
            }
        }
        return raised;
    }

    [[nodiscard]] std::uint8_t choice_around(std::span<const TexelWindow::Member> neighbours, std::size_t half) const {
        std::array<std::uint8_t, 13> chosen{};
        const auto end = std::transform(neighbours.begin(), neighbours.end(), chosen.begin(),
                                        [&](const TexelWindow::Member& member) { return choices_[member.texel][half]; });
        const auto rank = chosen.begin() + static_cast<std::ptrdiff_t>(raised_to * static_cast<double>(neighbours.size()));
        std::nth_element(chosen.begin(), rank, end);
        return *rank;
    }

    /// Each half takes the disc that the other has chosen: what chooses knows nothing of the noise that is averaged, so that no
    /// outlier decides about itself, and the mean stays true.
    void set_light(std::uint32_t index, WeightCache& cache, SharedLight& result) {
        DiscFits fits(light_, grid_, index, cache);
        const Choice chosen = raised_choice(index, fits);
        const DiscFit &first = fits[chosen[1]], &second = fits[chosen[0]];
        for (int c = 0; c < 3; ++c)
            result.irradiance[index][c] = static_cast<float>(std::max((first.values[c] + second.values[3 + c]) * 0.5, 0.0));
        result.standard_error[index] = static_cast<float>(0.5 * std::sqrt(first.variance[0] + second.variance[1]));
        const double square = 0.5 * (excess(fits, chosen[1], 0) + excess(fits, chosen[0], 1));
        bias_[index] = static_cast<float>(std::copysign(std::sqrt(std::abs(square)), square));
    }

    /// Square of what sharing changes beyond noise, signed: no more than noise has to come out as nothing on average. A disc holds the
    /// smaller one, so what they differ by has the difference of their variances.
    static double excess(DiscFits& fits, std::size_t chosen, std::size_t half) {
        if (chosen == 0) return 0;
        const DiscFit &taken = fits[chosen], &smaller = fits[chosen - 1];
        const double difference = taken.luminance(half) - smaller.luminance(half);
        return difference * difference - std::max(smaller.variance[half] - taken.variance[half], 0.0);
    }

    /// Mean of the squares over the texels around one, as a root.
    [[nodiscard]] float bias(std::uint32_t index) const {
        TexelWindow window(grid_, index);
        double sum = 0;
        for (std::size_t k = 0; k <= DiscFits::smallest_noise_disc; ++k)
            for (const TexelWindow::Member& member : window.grow(k)) {
                const auto root = static_cast<double>(bias_[member.texel]);
                sum += root * std::abs(root);
            }
        return static_cast<float>(std::sqrt(std::max(sum / static_cast<double>(window.members().size()), 0.0)));
    }

    const PageTexels& page_;
    const GatheredLight& light_;
    TexelGrid grid_;
    std::size_t discs_ = 0;
    std::vector<Choice> choices_;
    /// Per texel, its bias as it alone knows it, lux; below 0: that of its square. Not the square itself, which leaves the range of float
    /// where the light is 1e30 lux, or 1e-30.
    std::vector<float> bias_;
};

}  // namespace

SharedLight share_light(const PageTexels& page, std::uint32_t page_size, const GatheredLight& light,
                        std::uint32_t most_texels) {
    return Sharer(page, page_size, light, most_texels).share();
}

}  // namespace luxel
