#include "baker/accuracy/replicate_gain.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <tuple>
#include <unordered_map>

#include "baker/core/sobol.h"

namespace luxel {
namespace {

struct Gathered {
    double light = 0, rays = 0;  ///< sum n_ij B_j and sum n_ij of one replicate
};

double gain_of(double measured, double independent) {
    return independent > 0 ? std::clamp(measured / independent, 0.02, 2.0) : 1.0;
}

/// Spread of single counts over the replicates of some patches, by size of the count. Over all rounds together: the points of one
/// round fill what those of the others leave free, so that the sum is more even than its parts.
class CountSpread {
  public:
    /// Of each power of two of rays the `most_per_level` patches whose ids come first in a fixed random order.
    CountSpread(const LightState& light, std::uint32_t replicates) : replicates_(replicates), place_(light.ids.size(), unwatched) {
        std::map<int, std::vector<std::pair<std::uint64_t, std::size_t>>> by_level;
        for (std::size_t p = 0; p < light.ids.size(); ++p)
            if (const double rays = light.mu[p] * light.area_m2[p]; rays >= 1) by_level[std::ilogb(rays)].emplace_back(mix(light.ids[p]), p);
        for (auto& [level, patches] : by_level) {
            std::sort(patches.begin(), patches.end());
            if (patches.size() > most_per_level) patches.resize(most_per_level);
            for (const auto& [order, p] : patches) place_[p] = static_cast<std::uint32_t>(hits_.size()), hits_.emplace_back();
        }
    }

    [[nodiscard]] bool watches(std::size_t patch) const { return place_[patch] != unwatched; }
    void add(std::size_t patch, std::size_t target, std::uint32_t replicate, std::uint32_t count) {
        hits_[place_[patch]].push_back({static_cast<std::uint32_t>(target), replicate, count});
    }

    [[nodiscard]] std::array<double, 33> gains() {
        std::array<double, 33> measured{}, independent{}, gains{};
        for (auto& hits : hits_) {
            std::sort(hits.begin(), hits.end(), [](const Hit& a, const Hit& b) { return std::tie(a.target, a.replicate) < std::tie(b.target, b.replicate); });
            for (std::size_t k = 0; k < hits.size();) k = add_target(hits, k, measured, independent);
        }
        double last = 1;
        for (std::size_t bin = 0; bin < gains.size(); ++bin) {
            if (independent[bin] > 0) last = gain_of(measured[bin], independent[bin]);
            gains[bin] = last;  // larger counts than were seen: as the largest seen
        }
        return gains;
    }

  private:
    struct Hit {
        std::uint32_t target, replicate, count;
    };
    static constexpr std::uint32_t unwatched = 0xffffffffu;
    static constexpr std::size_t most_per_level = 64;

    /// Hits on one target, from `first`; returns the first of the next.
    std::size_t add_target(const std::vector<Hit>& hits, std::size_t first, std::array<double, 33>& measured, std::array<double, 33>& independent) const {
        double sum = 0, square = 0;
        std::size_t k = first;
        while (k < hits.size() && hits[k].target == hits[first].target) {
            const std::uint32_t replicate = hits[k].replicate;
            double n = 0;
            for (; k < hits.size() && hits[k].target == hits[first].target && hits[k].replicate == replicate; ++k) n += hits[k].count;
            sum += n;
            square += n * n;
        }
        const double r = replicates_;
        const auto bin = static_cast<std::size_t>(std::ilogb(sum));
        measured[bin] += (square - sum * sum / r) * r / (r - 1);
        independent[bin] += sum;
        return k;
    }

    std::uint32_t replicates_;
    std::vector<std::uint32_t> place_;  ///< per patch: index into hits_, or unwatched
    std::vector<std::vector<Hit>> hits_;
};

/// Patches of one kind: as many rays, light as rough.
struct GainBin {
    double measured = 0, independent = 0;
    std::size_t patches = 0;
    void add(double measured_of_one, double independent_of_one) {
        measured += measured_of_one, independent += independent_of_one, ++patches;
    }
    [[nodiscard]] double gain() const { return gain_of(measured, independent); }
};
constexpr std::size_t levels = 64, roughness_bins = 12;
/// Their ratio of variances is known to a fifth: four replicates each have a relative variance of 2 / 3.
constexpr std::size_t enough_patches = 16;

/// By powers of four of the variance of one ray's light relative to its squared mean; 4^-8 and less to 4^2 and more.
std::size_t roughness_bin(double relative_variance) {
    if (!(relative_variance > 0)) return 0;
    return static_cast<std::size_t>(std::clamp(std::ilogb(relative_variance) / 2 + 8, 0, static_cast<int>(roughness_bins) - 1));
}

/// What all records say of each patch.
class Tally {
  public:
    Tally(const LightState& light, std::uint32_t replicates)
        : light_(light), replicates_(replicates), gathered_(light.ids.size() * replicates), square_(light.ids.size()),
          counts_(light, replicates) {
        for (std::size_t p = 0; p < light.ids.size(); ++p) number_.emplace(light.ids[p], p);
    }

    void add(const EvidenceBlock& block, const std::string& where) {
        std::vector<std::size_t> target(block.targets.size());
        std::vector<double> brightness(block.targets.size());
        for (std::size_t t = 0; t < target.size(); ++t) {
            target[t] = find(block.targets[t], where);
            brightness[t] = brightness_of(target[t]);
        }
        for (const EvidenceBlock::Row& row : block.rows) {
            const std::size_t patch = find(row.patch_id, where);
            if (row.replicate >= replicates_)
                throw Error(ErrorCode::damaged_store, where, "replicate " + std::to_string(row.replicate) + " of " + std::to_string(replicates_));
            Gathered& g = gathered_[patch * replicates_ + row.replicate];
            const bool watched = replicates_ > 1 && counts_.watches(patch);
            g.rays += static_cast<double>(row.open) + static_cast<double>(row.back);
            for (std::uint32_t k = row.first; k < row.first + row.count; ++k) {
                const double n = block.counts[k], b = brightness[block.target_index[k]];
                g.rays += n;
                g.light += n * b;
                square_[patch] += n * b * b;
                if (watched) counts_.add(patch, target[block.target_index[k]], row.replicate, block.counts[k]);
            }
        }
    }

    [[nodiscard]] ReplicateGains gains() { return {row_gains(), counts_.gains()}; }

  private:
    [[nodiscard]] std::vector<double> row_gains() const {
        std::vector<GainBin> by_level(levels), by_kind(levels * roughness_bins);
        std::vector<std::size_t> kind(light_.ids.size(), by_kind.size());
        for (std::size_t p = 0; p < kind.size(); ++p) {
            double light = 0, rays = 0;
            for (std::uint32_t r = 0; r < replicates_; ++r) {
                const Gathered& g = gathered_[p * replicates_ + r];
                light += g.light;
                rays += g.rays;
            }
            if (!(light > 0)) continue;
            const double mean = light / rays;
            const double relative = std::max(square_[p] / rays / (mean * mean) - 1, 0.0);
            kind[p] = static_cast<std::size_t>(std::ilogb(rays)) * roughness_bins + roughness_bin(relative);
            by_kind[kind[p]].add(spread(p, mean) / (mean * mean), relative / rays);
            by_level[kind[p] / roughness_bins].add(spread(p, mean) / (mean * mean), relative / rays);
        }
        std::vector<double> gains(kind.size(), 1.0);
        if (replicates_ < 2) return gains;
        for (std::size_t p = 0; p < gains.size(); ++p)
            if (kind[p] < by_kind.size())
                gains[p] = (by_kind[kind[p]].patches >= enough_patches ? by_kind[kind[p]] : by_level[kind[p] / roughness_bins]).gain();
        return gains;
    }

    std::size_t find(PatchId id, const std::string& where) const {
        const auto at = number_.find(id);
        if (at == number_.end())
            throw Error(ErrorCode::damaged_store, where, "patch id " + std::to_string(id) + " is not in this scene",
                        "the evidence belongs to another scene; use a fresh bake folder");
        return at->second;
    }
    [[nodiscard]] double brightness_of(std::size_t patch) const {
        const Channels& b = light_.radiosity[patch];
        return b[0] + b[1] + b[2];
    }
    /// Variance of the mean over replicates; all have the same number of rays.
    [[nodiscard]] double spread(std::size_t p, double mean) const {
        double sum = 0;
        for (std::uint32_t r = 0; r < replicates_; ++r) {
            const Gathered& g = gathered_[p * replicates_ + r];
            const double difference = (g.rays > 0 ? g.light / g.rays : 0.0) - mean;
            sum += difference * difference;
        }
        return replicates_ > 1 ? sum / (replicates_ * (replicates_ - 1.0)) : 0.0;
    }

    const LightState& light_;
    std::uint32_t replicates_;
    std::vector<Gathered> gathered_;
    std::vector<double> square_;  ///< sum n_ij B_j^2
    CountSpread counts_;
    std::unordered_map<PatchId, std::size_t> number_;
};

}  // namespace

double ReplicateGains::of_count(double rays) const {
    if (!(rays >= 2)) return 1;
    return counts[static_cast<std::size_t>(std::min(32, std::ilogb(rays)))];
}

ReplicateGains replicate_gains(const EvidenceSource& evidence, const LightState& light, std::uint32_t replicates) {
    check(light);
    Tally tally(light, replicates);
    evidence.visit([&](const EvidenceBlock& block, const std::string& where) { tally.add(block, where); });
    return tally.gains();
}

}  // namespace luxel
