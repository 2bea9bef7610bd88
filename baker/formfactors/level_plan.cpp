#include "baker/formfactors/level_plan.h"

#include <algorithm>
#include <cmath>

#include "formats/base/error.h"

namespace luxel {
namespace {

/// Level whose ray count is nearest to `rays` in the logarithm, between `least` and highest_level.
std::uint8_t nearest_level(double rays, std::uint32_t replicates, std::uint8_t least) {
    const double scaled = rays / replicates * 1.4142135623730951;  // rounds the logarithm instead of cutting it
    if (!(scaled >= 2)) return least;
    const int level = std::min<int>(std::ilogb(scaled), highest_level);
    return std::max(least, static_cast<std::uint8_t>(level));
}

std::uint64_t rays_at(std::span<const double> wanted, std::span<const std::uint8_t> reached, std::uint32_t replicates,
                      double scale) {
    std::uint64_t sum = 0;
    for (std::size_t p = 0; p < wanted.size(); ++p)
        sum += std::uint64_t{replicates} << nearest_level(wanted[p] * scale, replicates, reached[p]);
    return sum;
}

}  // namespace

LevelPlan uniform_plan(std::size_t patch_count, std::uint32_t replicates, std::uint64_t rays) {
    std::uint8_t last = 0;
    while (last < 31 && (std::uint64_t{replicates} << last) < rays) ++last;
    return {std::vector<LevelRange>(patch_count, LevelRange{0, last})};
}

std::uint64_t planned_rays(const LevelPlan& plan, std::uint32_t replicates, PatchNumber begin, PatchNumber end) {
    std::uint64_t rays = 0;
    for (PatchNumber patch = begin; patch < end; ++patch) rays += ray_count(plan.levels[patch]) * replicates;
    return rays;
}

std::uint64_t planned_rays(const LevelPlan& plan, const Estimator& estimator, PatchNumber begin, PatchNumber end) {
    std::uint64_t rays = 0;
    for (PatchNumber patch = begin; patch < end; ++patch) rays += estimator.rays_of(plan.levels[patch]);
    return rays;
}

LevelPlan plan_by_want(std::span<const double> wanted, std::span<const std::uint8_t> reached, std::uint32_t replicates,
                       std::uint64_t total_rays) {
    if (wanted.size() != reached.size())
        throw Error(ErrorCode::internal, "plan of levels", "wanted and reached need one entry per patch");
    LevelPlan plan{std::vector<LevelRange>(wanted.size(), no_levels)};
    const double largest = wanted.empty() ? 0 : *std::max_element(wanted.begin(), wanted.end());
    if (!(largest > 0) || !std::isfinite(largest)) return plan;
    // The sum grows with the scale: halve the interval of its logarithm. At the lower end nobody gets anything new, at the
    // upper end the patch that wants most gets everything.
    double low = -60, high = 60;
    const double unit = static_cast<double>(total_rays) / largest;
    for (int step = 0; step < 50; ++step) {
        const double middle = 0.5 * (low + high);
        (rays_at(wanted, reached, replicates, unit * std::exp2(middle)) <= total_rays ? low : high) = middle;
    }
    const double scale = unit * std::exp2(low);
    for (std::size_t p = 0; p < wanted.size(); ++p) {
        const std::uint8_t level = nearest_level(wanted[p] * scale, replicates, reached[p]);
        if (level > reached[p]) plan.levels[p] = {static_cast<std::uint8_t>(reached[p] + 1), level};
    }
    return plan;
}

std::vector<std::uint8_t> levels_after(std::span<const std::uint8_t> reached, const LevelPlan& round) {
    std::vector<std::uint8_t> after(round.levels.size());
    for (std::size_t p = 0; p < after.size(); ++p) {
        if (!round.levels[p].empty())
            after[p] = round.levels[p].last;
        else if (!reached.empty())
            after[p] = reached[p];
    }
    return after;
}

}  // namespace luxel
