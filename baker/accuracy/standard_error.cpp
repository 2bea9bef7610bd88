#include "baker/accuracy/standard_error.h"

#include <algorithm>
#include <cmath>

#include "baker/accuracy/error_propagation.h"
#include "baker/core/sobol.h"

namespace luxel {
namespace {

constexpr std::size_t local = pattern_count;  ///< place of the local variance behind the patterns
using NoiseSums = PatchSums<pattern_count + 1>;

/// Signs of all patterns for a pair, the same for (i, j) and (j, i); one bit each.
std::uint64_t signs_of(PatchId i, PatchId j) { return mix(i ^ j, i + j); }

void add_noise(std::array<double, pattern_count + 1>& to, double error, std::uint64_t signs) {
    for (std::size_t v = 0; v < pattern_count; ++v) to[v] += (signs >> v) & 1 ? error : -error;
    to[local] += error * error;
}

/// Wrong light arriving per patch, lm, per pattern; and its variance.
NoiseSums pair_noise(BlockSource& source, const LightState& light, const ReplicateGains& gains, std::size_t c) {
    NoiseSums noise = sum_over_pairs<pattern_count + 1>(source, [&](PatchNumber i, PatchNumber j, double area_m2, auto& to_i, auto& to_j) {
        const double mu_i = light.mu[i], mu_j = light.mu[j], mu = mu_i + mu_j;
        const double from_i = gains.of_count(area_m2 * mu_i), from_j = gains.of_count(area_m2 * mu_j);
        const double sigma_i = std::sqrt(area_m2 * (mu_i * gains.rows[i] + mu_j * from_j)) / mu;
        const double sigma_j = std::sqrt(area_m2 * (mu_i * from_i + mu_j * gains.rows[j])) / mu;
        const std::uint64_t signs = signs_of(light.ids[i], light.ids[j]);
        add_noise(to_i, sigma_i * (light.radiosity[j][c] - light.row_mean[i][c]), signs);
        add_noise(to_j, sigma_j * (light.radiosity[i][c] - light.row_mean[j][c]), signs);
    });
    // What ends in the open or on the patch itself.
    for (std::size_t i = 0; i < noise.size(); ++i) {
        if (!(light.mu[i] > 0)) continue;
        const auto sigma = [&](double area_m2) { return std::sqrt(std::max(area_m2, 0.0) * gains.rows[i] / light.mu[i]); };
        add_noise(noise[i], -sigma(light.open_m2[i]) * light.row_mean[i][c], mix(light.ids[i]));
        add_noise(noise[i], sigma(source.diagonal_m2()[i]) * (light.radiosity[i][c] - light.row_mean[i][c]), mix(light.ids[i], 2));
    }
    return noise;
}

/// Every patch gets its share, by area, of what the patches of its neighbourhood have together.
void share_among_neighbours(const LightState& light, std::vector<double>& amount) {
    std::vector<double> sum(amount.size()), area_m2(amount.size());
    for (std::size_t i = 0; i < amount.size(); ++i) {
        sum[light.neighbourhood[i]] += amount[i];
        area_m2[light.neighbourhood[i]] += light.area_m2[i];
    }
    for (std::size_t i = 0; i < amount.size(); ++i)
        amount[i] = light.area_m2[i] * sum[light.neighbourhood[i]] / area_m2[light.neighbourhood[i]];
}

/// Variance of H per patch in one channel.
std::vector<double> irradiance_variance(BlockSource& source, const LightState& light, const ReplicateGains& gains,
                                        std::size_t c) {
    std::vector<double> arriving(light.ids.size()), bounces(light.ids.size());  // variance in lm2; A times that of H
    Patterns noise(light.ids.size());
    double scale = 0;  // patterns are in single precision: without it extreme brightness would leave its range
    for (const Channels& b : light.radiosity) scale = std::max(scale, b[c]);
    {
        const NoiseSums sums = pair_noise(source, light, gains, c);
        for (std::size_t i = 0; i < sums.size(); ++i) {
            for (std::size_t v = 0; v < pattern_count; ++v) noise[i][v] = static_cast<float>(sums[i][v] / scale);
            arriving[i] = sums[i][local];
        }
    }
    const Patterns with_bounces = propagate_errors(source, light, c, noise);
    for (std::size_t i = 0; i < noise.size(); ++i) {
        double added = 0;
        for (std::size_t v = 0; v < pattern_count; ++v) {
            const double before = static_cast<double>(noise[i][v]) / light.area_m2[i], after = with_bounces[i][v];
            added += after * after - before * before;
        }
        bounces[i] = light.area_m2[i] * added / static_cast<double>(pattern_count) * scale * scale;
    }
    share_among_neighbours(light, arriving);
    share_among_neighbours(light, bounces);
    std::vector<double> variance(light.ids.size());
    for (std::size_t i = 0; i < variance.size(); ++i)
        variance[i] = arriving[i] / (light.area_m2[i] * light.area_m2[i]) + std::max(0.0, bounces[i] / light.area_m2[i]);
    return variance;
}

}  // namespace

StandardError standard_error(BlockSource& source, const LightState& light, const ReplicateGains& gains,
                             double mean_irradiance) {
    check(light);
    const std::size_t count = light.ids.size();
    StandardError result{std::vector<Channels>(count, Channels{}), std::vector<Channels>(count, Channels{}), 0};
    const std::array<double, 3> weight{0.2126, 0.7152, 0.0722};
    std::vector<double> luminance_sigma(count);
    std::vector<double> variance;
    for (std::size_t c = 0; c < 3; ++c) {
        if (is_dark(light, c)) continue;
        if (variance.empty() || !same_channel(light, c - 1, c)) variance = irradiance_variance(source, light, gains, c);
        for (std::size_t i = 0; i < count; ++i) {
            const double sigma = std::sqrt(variance[i]);
            result.irradiance[i][c] = sigma;
            result.radiosity[i][c] = static_cast<double>(light.reflectance[i][static_cast<int>(c)]) * sigma;
            luminance_sigma[i] += weight[c] * sigma;  // the same rays serve all channels: their errors go together
        }
    }
    double square = 0, area = 0;
    for (std::size_t i = 0; i < count; ++i) {
        square += light.area_m2[i] * luminance_sigma[i] * luminance_sigma[i];
        area += light.area_m2[i];
    }
    if (mean_irradiance > 0 && area > 0) result.relative = std::sqrt(square / area) / mean_irradiance;
    return result;
}

}  // namespace luxel
