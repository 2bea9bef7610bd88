#include "baker/plan/sight_sample.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "baker/bake/estimator_choice.h"
#include "baker/core/parallel.h"
#include "baker/plan/idle_time.h"

namespace luxel {
namespace {

constexpr std::uint64_t most_patches = 512, least_patches = 64;
constexpr std::uint64_t most_rays = 1 << 19;

struct Sighting {
    PatchNumber from = no_patch;
    std::map<PatchNumber, std::uint32_t> times;  ///< that its rays met each patch; of the hemicube what its pixels weigh
};

std::vector<Sighting> cast_some(const Estimator& estimator, LevelRange levels, std::size_t patches) {
    std::vector<Sighting> seen(std::min<std::size_t>(patches, std::clamp(most_rays / estimator.rays_of(levels), least_patches, most_patches)));
    parallel_for(seen.size(), 4, [&](std::size_t k) {
        flush_denormals();
        seen[k].from = static_cast<PatchNumber>((2 * k + 1) * patches / (2 * seen.size()));
        std::vector<Landings> landings;
        estimator.cast(seen[k].from, levels, landings);
        for (const Landings& replicate : landings)
            for (std::size_t at = 0; at < replicate.patches.size(); ++at)
                seen[k].times[replicate.patches[at]] += replicate.weights.empty() ? 1 : replicate.weights[at];
    });
    return seen;
}

/// Bits that say which of the patches of the blocks it has something in a patch meets, per patch that it meets: log2(there are / are met).
double index_bits(const std::vector<Sighting>& seen, const ChunkLayout& layout) {
    double bits = 0, met = 0;
    for (const Sighting& sighting : seen) {
        const auto partners = static_cast<double>(sighting.times.size());
        double there = 0;
        std::uint32_t last = layout.chunk_count();
        for (const auto& [patch, times] : sighting.times)
            if (const std::uint32_t chunk = layout.chunk_of(patch); chunk != last) {
                last = chunk;
                there += layout.size(chunk);
            }
        if (partners > 0) bits += partners * std::log2(there / partners);
        met += partners;
    }
    return met > 0 ? bits / met : 0;
}

/// A pair that both of its patches meet is counted once: the chance that the other one meets this one follows by reciprocity from how
/// often this one met it. Of those that were met once or twice many were met by luck, and their rate is lower.
double expected_pairs(const std::vector<Sighting>& seen, const PatchSet& patches) {
    std::map<std::uint32_t, double> met;  // times -> patches
    for (const Sighting& sighting : seen)
        for (const auto& [patch, times] : sighting.times) ++met[times];
    const auto rate = [&](std::uint32_t times) {
        const auto more = met.find(times + 1);
        const double plain = times;
        return times <= 2 && more != met.end() ? std::min(plain, (plain + 1) * more->second / met[times]) : plain;
    };
    double pairs = 0;
    for (const Sighting& sighting : seen)
        for (const auto& [patch, times] : sighting.times) {
            const auto area_ratio = static_cast<double>(patches.patches[sighting.from].area_m2 / patches.patches[patch].area_m2);
            pairs += 1 - (1 - std::exp(-rate(times) * area_ratio)) / 2;
        }
    return pairs * static_cast<double>(patches.count()) / static_cast<double>(seen.size());
}

}  // namespace

SightSample sample_sight(const BakeOptions& options, const BakedGeometry& g) {
    if (g.patches.count() == 0) return {};
    const auto estimator = make_estimator(options, g);
    const LevelRange levels = first_levels(options, options.rays);
    const IdleTime time(options.threads);
    const std::vector<Sighting> seen = cast_some(*estimator, levels, g.patches.count());
    const double seconds = time.seconds();
    const std::uint64_t cast = estimator->rays_of(levels);
    const std::uint64_t rays = options.estimator == EstimatorKind::hemicube ? cast : options.rays;  // an average, while a sample casts whole levels
    return {expected_pairs(seen, g.patches), index_bits(seen, g.layout), rays, seconds / static_cast<double>(cast * seen.size())};
}

}  // namespace luxel
