#include "baker/accuracy/ray_allocation.h"

#include <algorithm>
#include <cmath>

#include "baker/accuracy/pair_pass.h"
#include "baker/accuracy/sensitivity.h"

namespace luxel {
namespace {

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

/// Of the patches that share one density.
struct Shared {
    double left = 0, rays = 0, area_m2 = 0;
    void add(double left_of_one, double rays_of_one, double area_of_one) {
        left += left_of_one, rays += rays_of_one, area_m2 += area_of_one;
    }
    /// The next, up to the common factor.
    [[nodiscard]] double density() const { return rays / area_m2 * std::sqrt(left / area_m2); }
};

}  // namespace

std::vector<double> best_rays(BlockSource& source, const LightState& light, double total_rays, double floor_rays,
                              std::uint32_t passes) {
    check(light);
    const std::size_t count = light.ids.size();
    std::vector<double> rays(count, count > 0 ? total_rays / static_cast<double>(count) : 0.0), density(count);
    const Sensitivity sensitivity(source, light);
    for (std::uint32_t pass = 0; pass < passes; ++pass) {
        for (std::size_t i = 0; i < count; ++i) density[i] = rays[i] / light.area_m2[i];
        const PatchSums<1> sums = sum_over_pairs<1>(source, [&](PatchNumber i, PatchNumber j, double area_m2, auto& to_i, auto& to_j) {
            const double density_sum = density[i] + density[j];
            const double gain = area_m2 * sensitivity.of_pair(i, j) / (density_sum * density_sum);
            to_i[0] += gain;
            to_j[0] += gain;
        });
        std::vector<Shared> shared(count);
        for (std::size_t i = 0; i < count; ++i) {
            const double open_gain = light.open_m2[i] * sensitivity.of_open(static_cast<PatchNumber>(i)) / (density[i] * density[i]);
            shared[light.neighbourhood[i]].add(sums[i][0] + std::max(0.0, open_gain), rays[i], light.area_m2[i]);
        }
        for (std::size_t i = 0; i < count; ++i) rays[i] = light.area_m2[i] * shared[light.neighbourhood[i]].density();
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
