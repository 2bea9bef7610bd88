#include "baker/light/share_light.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "baker/core/parallel.h"

namespace luxel {
namespace {

constexpr int most_radius = 8;
constexpr int width = 2 * most_radius + 1;
/// Discs that are tried, by squared radius: 1, 5, 13, 81 and 197 texels where all are there. A plane is fitted to the small
/// ones; to the large ones a quadratic, since light that bends over them would lose its peaks.
constexpr std::array<int, 5> disc_squares{0, 1, 4, 25, 62};
constexpr std::array<int, 5> disc_radii{0, 1, 2, 5, 8};
constexpr std::size_t first_quadratic = 3;
/// Noise is pooled over the disc, but over no smaller one than this: 13 texels know it to a fifth or so.
constexpr std::size_t smallest_noise_disc = 2;
/// Half width of the intervals in standard errors.
constexpr double confidence = 1.4;

struct Place {
    int dx, dy;
};

/// What a disc says of its middle: values of both halves, and the variance of each (of a fit: for values of variance 1).
struct Disc {
    std::array<Rgb, 2> values;
    double variance = 1;  ///< in double: the light of 1e-30 has one too
};

/// Places of the window by disc: those of disc k that are not in disc k - 1.
const std::array<std::vector<Place>, disc_radii.size()>& rings() {
    static const std::array<std::vector<Place>, disc_radii.size()> all = [] {
        std::array<std::vector<Place>, disc_radii.size()> made;
        for (int dy = -most_radius; dy <= most_radius; ++dy)
            for (int dx = -most_radius; dx <= most_radius; ++dx)
                for (std::size_t k = 0; k < disc_squares.size(); ++k)
                    if (dx * dx + dy * dy <= disc_squares[k]) {
                        made[k].push_back({dx, dy});
                        break;
                    }
        // Nearest first: a place is reached over places that lie nearer.
        for (auto& ring : made)
            std::stable_sort(ring.begin(), ring.end(),
                             [](const Place& a, const Place& b) { return a.dx * a.dx + a.dy * a.dy < b.dx * b.dx + b.dy * b.dy; });
        return made;
    }();
    return all;
}

/// Texels by place on the page.
class TexelGrid {
  public:
    TexelGrid(const PageTexels& page, std::uint32_t size) : page_(page), size_(size), index_(std::size_t{size} * size, none) {
        for (std::size_t k = 0; k < page.texels.size(); ++k)
            index_[std::size_t{page.texels[k].y} * size + page.texels[k].x] = static_cast<std::uint32_t>(k);
    }
    [[nodiscard]] std::uint32_t at(int x, int y) const {
        const auto size = static_cast<int>(size_);
        return x < 0 || y < 0 || x >= size || y >= size
                   ? none
                   : index_[static_cast<std::size_t>(y) * size_ + static_cast<std::size_t>(x)];
    }
    [[nodiscard]] const Texel& texel(std::uint32_t index) const { return page_.texels[index]; }

  private:
    const PageTexels& page_;
    std::uint32_t size_;
    std::vector<std::uint32_t> index_;
};

/// The neighbours of one texel, found ring by ring.
class Window {
  public:
    Window(const TexelGrid& grid, std::uint32_t centre) : grid_(grid), x_(grid.texel(centre).x), y_(grid.texel(centre).y) {
        found_.fill(none);
        found_[slot({0, 0})] = centre;
    }
    /// The neighbour there, none if there is no way to it. Nearer places must have been asked for before.
    std::uint32_t reach(const Place& to) {
        if (to.dx == 0 && to.dy == 0) return found_[slot(to)];
        const std::uint32_t there = grid_.at(x_ + to.dx, y_ + to.dy);
        if (there == none) return none;
        bool is_reached = false;
        if (to.dx != 0) {
            const Place from{to.dx > 0 ? to.dx - 1 : to.dx + 1, to.dy};
            const std::uint32_t before = found_[slot(from)];
            is_reached = before != none && joined(to.dx > 0 ? before : there, to.dx > 0 ? there : before, true);
        }
        if (!is_reached && to.dy != 0) {
            const Place from{to.dx, to.dy > 0 ? to.dy - 1 : to.dy + 1};
            const std::uint32_t before = found_[slot(from)];
            is_reached = before != none && joined(to.dy > 0 ? before : there, to.dy > 0 ? there : before, false);
        }
        return is_reached ? found_[slot(to)] = there : none;
    }

  private:
    static std::size_t slot(const Place& p) {
        return static_cast<std::size_t>((p.dy + most_radius) * width + p.dx + most_radius);
    }
    [[nodiscard]] bool joined(std::uint32_t first, std::uint32_t second, bool right) const {
        const Texel &a = grid_.texel(first), &b = grid_.texel(second);
        return a.chart == b.chart && (right ? a.joined_right : a.joined_down);
    }
    const TexelGrid& grid_;
    int x_, y_;
    std::array<std::uint32_t, width * width> found_;
};

/// A polynomial in the place through the values of both halves of the rays: moments, added up.
template <int terms>
class LocalFit {
  public:
    void add(const Place& at, const std::array<Rgb, 2>& values) {
        const auto x = static_cast<double>(at.dx) / most_radius, y = static_cast<double>(at.dy) / most_radius;
        Eigen::Matrix<double, terms, 1> basis;
        basis[0] = 1, basis[1] = x, basis[2] = y;
        if constexpr (terms == 6) basis[3] = x * x, basis[4] = x * y, basis[5] = y * y;
        moments_ += basis * basis.transpose();
        Eigen::Matrix<double, 1, 6> row;
        row << values[0].x, values[0].y, values[0].z, values[1].x, values[1].y, values[1].z;
        sums_ += basis * row;
    }
    /// Values at the middle, and the variance of each for values of variance 1.
    [[nodiscard]] Disc at_middle() const {
        // A little stiffness: a row of texels says nothing about the slope across it.
        Eigen::Matrix<double, terms, terms> matrix = moments_;
        for (int k = 1; k < terms; ++k) matrix(k, k) += 1e-4 * moments_(0, 0);
        const Eigen::Matrix<double, terms, 1> weights = matrix.ldlt().solve(Eigen::Matrix<double, terms, 1>::Unit(0));
        const Eigen::Matrix<double, 1, 6> values = weights.transpose() * sums_;
        Disc result;
        for (int half = 0; half < 2; ++half)
            for (int c = 0; c < 3; ++c) result.values[static_cast<std::size_t>(half)][c] = static_cast<float>(values[3 * half + c]);
        result.variance = weights.dot(moments_ * weights);
        return result;
    }

  private:
    Eigen::Matrix<double, terms, terms> moments_ = Eigen::Matrix<double, terms, terms>::Zero();
    Eigen::Matrix<double, terms, 6> sums_ = Eigen::Matrix<double, terms, 6>::Zero();
};
using PlaneFit = LocalFit<3>;
using QuadraticFit = LocalFit<6>;

/// The rule of intersecting intervals for one half: which disc is the largest that agrees with all smaller ones.
class Intervals {
  public:
    /// A disc's value and standard error. From the first that disagrees on, none is taken.
    void add(double value, double error) {
        low_ = std::max(low_, value - confidence * error), high_ = std::min(high_, value + confidence * error);
        if (low_ > high_) ended_ = true;
        if (!ended_) ++agreeing_;
    }
    [[nodiscard]] bool ended() const { return ended_; }
    [[nodiscard]] std::size_t largest() const { return agreeing_ - 1; }

  private:
    double low_ = -std::numeric_limits<double>::max(), high_ = std::numeric_limits<double>::max();
    std::size_t agreeing_ = 0;
    bool ended_ = false;
};

class Sharer {
  public:
    Sharer(const PageTexels& page, std::uint32_t page_size, const GatheredLight& light, std::uint32_t most_texels)
        : light_(light), grid_(page, page_size) {
        while (discs_ < disc_radii.size() && disc_radii[discs_] <= static_cast<int>(most_texels)) ++discs_;
        can_send_.resize(page.texels.size());
        for (std::size_t k = 0; k < page.texels.size(); ++k) can_send_[k] = page.can_send(page.texels[k]);
    }

    void share(std::uint32_t index, SharedLight& result) const {
        const std::array<Rgb, 2> own = values(index);
        result.irradiance[index] = (own[0] + own[1]) * 0.5f;
        if (!can_send_[index]) return;
        Window window(grid_, index);
        std::array<Disc, disc_radii.size()> discs;
        std::array<Intervals, 2> intervals;
        PlaneFit plane;
        QuadraticFit quadratic;
        NoiseSum noise;
        for (std::size_t k = 0; k <= smallest_noise_disc; ++k) add_noise(window, k, noise);
        for (std::size_t k = 0; k < discs_; ++k) {
            if (k > smallest_noise_disc) add_noise(window, k, noise);
            add_ring(window, k, plane, quadratic);
            discs[k] = k < first_quadratic ? plane.at_middle() : quadratic.at_middle();
            discs[k].variance *= noise.mean();
            // A larger disc that reaches into louder surroundings knows less.
            if (k > 0 && !(discs[k].variance < discs[k - 1].variance)) break;
            for (std::size_t half = 0; half < 2; ++half)
                intervals[half].add(static_cast<double>(luminance(discs[k].values[half])), std::sqrt(discs[k].variance));
            if (intervals[0].ended() && intervals[1].ended()) break;
        }
        choose(discs, {intervals[0].largest(), intervals[1].largest()}, index, result);
    }

  private:
    /// Each half takes the disc that the other has chosen: what chooses knows nothing of the noise that is averaged, so that no
    /// outlier decides about itself, and the mean stays true.
    static void choose(const std::array<Disc, disc_radii.size()>& discs, const std::array<std::size_t, 2>& largest,
                       std::uint32_t index, SharedLight& result) {
        const Disc &first = discs[largest[1]], &second = discs[largest[0]];
        for (int c = 0; c < 3; ++c)
            result.irradiance[index][c] = std::max((first.values[0][c] + second.values[1][c]) * 0.5f, 0.0f);
        result.standard_error[index] = static_cast<float>(0.5 * std::sqrt(first.variance + second.variance));
        // Against the largest disc but one, beyond what noise explains.
        const std::size_t chosen = std::min(largest[0], largest[1]);
        if (chosen == 0) return;
        const auto mean = [&](std::size_t disc) { return luminance(discs[disc].values[0] + discs[disc].values[1]) * 0.5f; };
        const auto expected = static_cast<float>(std::sqrt(0.5 * std::max(discs[chosen - 1].variance - discs[chosen].variance, 0.0)));
        result.bias[index] = std::max(0.0f, std::fabs(mean(chosen) - mean(chosen - 1)) - expected);
    }

    [[nodiscard]] std::array<Rgb, 2> values(std::uint32_t index) const {
        return {light_.halves[0][index], light_.halves[1][index]};
    }

    void add_ring(Window& window, std::size_t disc, PlaneFit& plane, QuadraticFit& quadratic) const {
        for (const Place& place : rings()[disc]) {
            const std::uint32_t there = window.reach(place);
            if (there == none || !can_send_[there]) continue;
            if (disc < first_quadratic) plane.add(place, values(there));
            quadratic.add(place, values(there));
        }
    }

    /// Variance of one half, from the differences of both.
    struct NoiseSum {
        double squares = 0;
        int count = 0;
        [[nodiscard]] double mean() const { return count ? squares / (2 * count) : 0; }
    };
    void add_noise(Window& window, std::size_t disc, NoiseSum& noise) const {
        for (const Place& place : rings()[disc]) {
            const std::uint32_t there = window.reach(place);
            if (there == none || !can_send_[there]) continue;
            const std::array<Rgb, 2> both = values(there);
            const auto difference = static_cast<double>(luminance(both[0]) - luminance(both[1]));
            noise.squares += difference * difference;
            ++noise.count;
        }
    }

    const GatheredLight& light_;
    TexelGrid grid_;
    std::vector<std::uint8_t> can_send_;
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
    const Sharer sharer(page, page_size, light, most_texels);
    parallel_ranges(count, 1024, [&](std::size_t, std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) sharer.share(static_cast<std::uint32_t>(k), result);
    });
    return result;
}

}  // namespace luxel
