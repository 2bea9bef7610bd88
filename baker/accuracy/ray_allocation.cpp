#include "baker/accuracy/ray_allocation.h"

#include <algorithm>
#include <cmath>

#include "baker/accuracy/pair_pass.h"

namespace luxel {
namespace {

/// rho_i^2 (B - H_i)^2 / A_i over the channels: what a m2 of wrong exchange with radiosity B costs patch i.
double cost(const LightState& light, PatchNumber i, const Channels& radiosity) {
    double sum = 0;
    for (std::size_t c = 0; c < 3; ++c) {
        const double error = static_cast<double>(light.reflectance[i][static_cast<int>(c)]) * (radiosity[c] - light.irradiance[i][c]);
        sum += error * error;
    }
    return sum / light.area_m2[i];
}

/// Scales rays to the total, floors kept: the free ones share what the floors leave.
void scale_to_total(std::vector<double>& rays, double total_rays, double floor_rays) {
    double low = 0, high = 1;
    const auto sum_at = [&](double scale) {
        double sum = 0;
        for (const double r : rays) sum += std::max(floor_rays, r * scale);
        return sum;
    };
    while (high < 1e30 && sum_at(high) < total_rays) high *= 2;
    for (int step = 0; step < 60; ++step) {
        const double middle = 0.5 * (low + high);
        (sum_at(middle) < total_rays ? low : high) = middle;
    }
    for (double& r : rays) r = std::max(floor_rays, r * high);
}

}  // namespace

std::vector<double> best_rays(BlockSource& source, const LightState& light, double total_rays, double floor_rays,
                              std::uint32_t passes) {
    check(light);
    const std::size_t count = light.ids.size();
    std::vector<double> rays(count, count > 0 ? total_rays / static_cast<double>(count) : 0.0), density(count);
    const Channels dark{0, 0, 0};
    for (std::uint32_t pass = 0; pass < passes; ++pass) {
        for (std::size_t i = 0; i < count; ++i) density[i] = rays[i] / light.area_m2[i];
        const PatchSums<1> sums = sum_over_pairs<1>(source, [&](PatchNumber i, PatchNumber j, double area_m2, auto& to_i, auto& to_j) {
            const double density_sum = density[i] + density[j];
            const double gain = area_m2 * (cost(light, i, light.radiosity[j]) + cost(light, j, light.radiosity[i])) /
                                (density_sum * density_sum);
            to_i[0] += gain;
            to_j[0] += gain;
        });
        for (std::size_t i = 0; i < count; ++i) {
            const double open_gain = light.open_m2[i] * cost(light, static_cast<PatchNumber>(i), dark) / (density[i] * density[i]);
            rays[i] *= std::sqrt((sums[i][0] + std::max(0.0, open_gain)) / light.area_m2[i]);
        }
        // Brightness has no scale of its own: keep the numbers in range before floors are compared with them.
        double sum = 0;
        for (const double r : rays) sum += r;
        if (!(sum > 0) || !std::isfinite(sum)) return std::vector<double>(count, total_rays / static_cast<double>(count));
        for (double& r : rays) r *= total_rays / sum;
        scale_to_total(rays, total_rays, floor_rays);
    }
    return rays;
}

}  // namespace luxel
