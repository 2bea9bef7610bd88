#include "baker/light/disc_fits.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "baker/core/sobol.h"

namespace luxel {
namespace {

/// A plane is fitted to the small discs; to the large ones a quadratic, since light that bends over them would lose its peaks.
constexpr std::size_t first_quadratic = 3;
/// No texel is taken for darker than this share of the root mean square around it: where most rays miss what few find, half of the texels are.
constexpr double least_light = 0.3;

using Values = Eigen::Matrix<double, 1, 6>;

double luminance_of(const Values& values, std::size_t half) {
    const auto first = static_cast<Eigen::Index>(3 * half);
    return 0.2126 * values[first] + 0.7152 * values[first + 1] + 0.0722 * values[first + 2];
}

Values values_of(const GatheredLight& light, std::uint32_t texel) {
    const Rgb &a = light.halves[0][texel], &b = light.halves[1][texel];
    Values values;
    values << static_cast<double>(a.x), static_cast<double>(a.y), static_cast<double>(a.z), static_cast<double>(b.x),
        static_cast<double>(b.y), static_cast<double>(b.z);
    return values;
}

/// Weights with which the values at some places give the value of a polynomial of least squares at the middle.
template <int terms>
void find_weights(std::span<const TexelWindow::Member> members, std::span<double> weights) {
    const auto basis_at = [](const TexelWindow::Place& place) {
        const double x = static_cast<double>(place.dx) / TexelWindow::most_radius, y = static_cast<double>(place.dy) / TexelWindow::most_radius;
        Eigen::Matrix<double, terms, 1> basis;
        basis[0] = 1, basis[1] = x, basis[2] = y;
        if constexpr (terms == 6) basis[3] = x * x, basis[4] = x * y, basis[5] = y * y;
        return basis;
    };
    Eigen::Matrix<double, terms, terms> moments = Eigen::Matrix<double, terms, terms>::Zero();
    for (const TexelWindow::Member& member : members) {
        const auto basis = basis_at(member.place);
        moments += basis * basis.transpose();
    }
    // A little stiffness: a row of texels says nothing about the slope across it.
    for (int k = 1; k < terms; ++k) moments(k, k) += 1e-4 * moments(0, 0);
    const Eigen::Matrix<double, terms, 1> of_middle = moments.ldlt().solve(Eigen::Matrix<double, terms, 1>::Unit(0));
    for (std::size_t k = 0; k < members.size(); ++k) weights[k] = of_middle.dot(basis_at(members[k].place));
}

void find_weights(std::size_t disc, std::span<const TexelWindow::Member> members, std::span<double> weights) {
    if (disc < first_quadratic)
        find_weights<3>(members, weights);
    else
        find_weights<6>(members, weights);
}

/// Weights of each disc where no texel of it is missing, as most are.
const std::array<std::vector<double>, TexelWindow::disc_count>& whole_weights() {
    static const auto all = [] {
        std::array<std::vector<double>, TexelWindow::disc_count> made;
        for (std::size_t disc = 0; disc < made.size(); ++disc) {
            std::vector<TexelWindow::Member> members;
            for (const TexelWindow::Place& place : TexelWindow::places().first(TexelWindow::disc_ends()[disc])) members.push_back({place, none});
            made[disc].resize(members.size());
            find_weights(disc, members, made[disc]);
        }
        return made;
    }();
    return all;
}

double median(std::vector<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

}  // namespace

double DiscFit::luminance(std::size_t half) const { return luminance_of(values, half); }

std::size_t WeightCache::Hash::operator()(const Key& key) const {
    std::uint64_t hash = key.disc;
    for (const std::uint64_t word : key.shape) hash = mix(hash, word);
    return hash;
}

std::span<const double> WeightCache::weights(std::size_t disc, const TexelWindow& window) {
    if (window.members().size() == whole_weights()[disc].size()) return whole_weights()[disc];
    std::vector<double>& own = found_[{disc, window.shape()}];
    if (own.empty()) {
        own.resize(window.members().size());
        find_weights(disc, window.members(), own);
    }
    return own;
}

DiscFits::DiscFits(const GatheredLight& light, const TexelGrid& grid, std::uint32_t centre, WeightCache& cache)
    : light_(light), cache_(cache), window_(grid, centre) {
    cache.next_texel();
    while (grown_ <= smallest_noise_disc) grow();
    find_light_near();
}

void DiscFits::grow() {
    const std::size_t before = window_.members().size();
    const auto added = window_.grow(grown_);
    for (std::size_t k = 0; k < added.size(); ++k) {
        values_[before + k] = values_of(light_, added[k].texel);
        const double first = luminances_[0][before + k] = luminance_of(values_[before + k], 0);
        const double second = luminances_[1][before + k] = luminance_of(values_[before + k], 1);
        noise_ += (first - second) * (first - second) / 2;
        light_squares_ += (first * first + second * second) / 2;
    }
    Level& level = levels_[grown_];
    level.weights = cache_.weights(grown_, window_);
    level.relative_noise = light_squares_ > 0 ? noise_ / light_squares_ : 0.0;
    for (std::size_t k = 0; k < grown_ && grown_ <= smallest_noise_disc; ++k) levels_[k].relative_noise = level.relative_noise;
    ++grown_;
}

/// How bright small discs are: one of their texels may be an outlier.
void DiscFits::find_light_near() {
    const double around = std::sqrt(light_squares_ / static_cast<double>(window_.members().size()));
    const auto near = static_cast<std::ptrdiff_t>(levels_[1].weights.size());
    for (std::size_t half = 0; half < 2; ++half) {
        median_beside_[half] = median({luminances_[half].begin(), luminances_[half].begin() + near});
        light_near_[half] = std::clamp(median_beside_[half], least_light * around, around);
    }
}

const DiscFit& DiscFits::operator[](std::size_t disc) {
    while (grown_ <= disc) grow();
    Level& level = levels_[disc];
    if (level.is_fitted) return level.fit;
    level.is_fitted = true;
    for (std::size_t k = 0; k < level.weights.size(); ++k) {
        level.fit.values += level.weights[k] * values_[k];
        for (std::size_t half = 0; half < 2; ++half) {
            const double loud = level.weights[k] * (disc < smallest_noise_disc ? light_near_[half] : luminances_[half][k]);
            level.fit.variance[half] += loud * loud;
        }
    }
    for (double& variance : level.fit.variance) variance *= level.relative_noise;
    return level.fit;
}

}  // namespace luxel
