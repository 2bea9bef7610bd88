#include "baker/accuracy/replicate_gain.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <unordered_map>

namespace luxel {
namespace {

struct Gathered {
    double error = 0, rays = 0;  ///< sum n_ij v_ij and sum n_ij of one replicate
};

double gain_of(double measured, double independent) {
    return independent > 0 ? std::clamp(measured / independent, 0.02, 2.0) : 1.0;
}

/// Spread of single counts over the replicates of a patch, by size of the count.
class CountSpread {
  public:
    explicit CountSpread(std::uint32_t replicates) : replicates_(replicates) {}

    /// Rows [first, first + replicates) of the block are the replicates of one patch and round.
    void add(const EvidenceBlock& block, std::size_t first) {
        hits_.clear();
        for (std::size_t r = first; r < first + replicates_; ++r)
            for (std::uint32_t k = block.rows[r].first; k < block.rows[r].first + block.rows[r].count; ++k)
                hits_.emplace_back(block.target_index[k], block.counts[k]);
        std::sort(hits_.begin(), hits_.end());
        for (std::size_t k = 0; k < hits_.size();) {
            const std::uint32_t target = hits_[k].first;
            double sum = 0, square = 0;
            for (; k < hits_.size() && hits_[k].first == target; ++k) {
                const double n = hits_[k].second;
                sum += n;
                square += n * n;
            }
            const double r = replicates_;
            const auto bin = static_cast<std::size_t>(std::ilogb(sum));
            measured_[bin] += (square - sum * sum / r) * r / (r - 1);
            independent_[bin] += sum;
        }
    }

    [[nodiscard]] std::array<double, 33> gains() const {
        std::array<double, 33> gains{};
        double last = 1;
        for (std::size_t bin = 0; bin < gains.size(); ++bin) {
            if (independent_[bin] > 0) last = gain_of(measured_[bin], independent_[bin]);
            gains[bin] = last;  // larger counts than were seen: as the largest seen
        }
        return gains;
    }

  private:
    std::uint32_t replicates_;
    std::array<double, 33> measured_{}, independent_{};
    std::vector<std::pair<std::uint32_t, std::uint32_t>> hits_;
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

/// By powers of four of the variance of one ray's error relative to the squared light; 4^-8 and less to 4^2 and more.
std::size_t roughness_bin(double relative_variance) {
    if (!(relative_variance > 0)) return 0;
    return static_cast<std::size_t>(std::clamp(std::ilogb(relative_variance) / 2 + 8, 0, static_cast<int>(roughness_bins) - 1));
}

/// What all records say of each patch.
class Tally {
  public:
    Tally(const LightState& light, std::uint32_t replicates)
        : light_(light), replicates_(replicates), gathered_(light.ids.size() * replicates), square_(light.ids.size()), arriving_(light.ids.size()),
          counts_(replicates) {
        for (std::size_t p = 0; p < light.ids.size(); ++p) number_.emplace(light.ids[p], p);
    }

    void add(const EvidenceBlock& block, const std::string& where) {
        struct Target {
            std::size_t patch;
            double brightness, mu;
        };
        std::vector<Target> targets;
        for (const PatchId id : block.targets) {
            const std::size_t patch = find(id, where);
            targets.push_back({patch, sum_of(light_.radiosity[patch]), light_.mu[patch]});
        }
        for (const EvidenceBlock::Row& row : block.rows) {
            const std::size_t patch = find(row.patch_id, where);
            if (row.replicate >= replicates_)
                throw Error(ErrorCode::damaged_store, where, "replicate " + std::to_string(row.replicate) + " of " + std::to_string(replicates_));
            Gathered& g = gathered_[patch * replicates_ + row.replicate];
            const double mean = sum_of(light_.row_mean[patch]), mu = light_.mu[patch];
            const auto add_rays = [&](double n, double v) {
                g.rays += n;
                g.error += n * v;
                square_[patch] += n * v * v;
            };
            add_rays(static_cast<double>(row.open) + static_cast<double>(row.back), -mean);
            for (std::uint32_t k = row.first; k < row.first + row.count; ++k) {
                const Target& target = targets[block.target_index[k]];
                const double share = target.patch == patch || !(mu > 0) ? 1.0 : mu / (mu + target.mu);
                add_rays(block.counts[k], (target.brightness - mean) * share);
                arriving_[patch] += block.counts[k] * target.brightness;
            }
        }
        if (replicates_ < 2) return;
        for (std::size_t first = 0; first < block.rows.size();) {
            const bool whole = all_replicates(block, first);
            if (whole) counts_.add(block, first);
            first += whole ? replicates_ : 1;
        }
    }

    [[nodiscard]] ReplicateGains gains() const { return {row_gains(), counts_.gains()}; }

  private:
    [[nodiscard]] std::vector<double> row_gains() const {
        std::vector<GainBin> by_level(levels), by_kind(levels * roughness_bins);
        std::vector<std::size_t> kind(light_.ids.size(), by_kind.size());
        for (std::size_t p = 0; p < kind.size(); ++p) {
            double error = 0, rays = 0;
            for (std::uint32_t r = 0; r < replicates_; ++r) {
                const Gathered& g = gathered_[p * replicates_ + r];
                error += g.error;
                rays += g.rays;
            }
            if (!(arriving_[p] > 0)) continue;
            const double mean = error / rays, light = arriving_[p] / rays;
            const double relative = std::max(square_[p] / rays - mean * mean, 0.0) / (light * light);
            kind[p] = static_cast<std::size_t>(std::ilogb(rays)) * roughness_bins + roughness_bin(relative);
            by_kind[kind[p]].add(spread(p, mean) / (light * light), relative / rays);
            by_level[kind[p] / roughness_bins].add(spread(p, mean) / (light * light), relative / rays);
        }
        std::vector<double> gains(kind.size(), 1.0);
        if (replicates_ < 2) return gains;
        for (std::size_t p = 0; p < gains.size(); ++p)
            if (kind[p] < by_kind.size())
                gains[p] = (by_kind[kind[p]].patches >= enough_patches ? by_kind[kind[p]] : by_level[kind[p] / roughness_bins]).gain();
        return gains;
    }

    [[nodiscard]] bool all_replicates(const EvidenceBlock& block, std::size_t first) const {
        if (first + replicates_ > block.rows.size()) return false;
        const EvidenceBlock::Row& head = block.rows[first];
        for (std::uint32_t r = 0; r < replicates_; ++r) {
            const EvidenceBlock::Row& row = block.rows[first + r];
            if (row.patch_id != head.patch_id || row.first_level != head.first_level || row.last_level != head.last_level) return false;
        }
        return true;
    }
    std::size_t find(PatchId id, const std::string& where) const {
        const auto at = number_.find(id);
        if (at == number_.end())
            throw Error(ErrorCode::damaged_store, where, "patch id " + std::to_string(id) + " is not in this scene",
                        "the evidence belongs to another scene; use a fresh bake folder");
        return at->second;
    }
    static double sum_of(const Channels& b) { return b[0] + b[1] + b[2]; }
    /// Variance of the mean over replicates; all have the same number of rays.
    [[nodiscard]] double spread(std::size_t p, double mean) const {
        double sum = 0;
        for (std::uint32_t r = 0; r < replicates_; ++r) {
            const Gathered& g = gathered_[p * replicates_ + r];
            const double difference = (g.rays > 0 ? g.error / g.rays : 0.0) - mean;
            sum += difference * difference;
        }
        return replicates_ > 1 ? sum / (replicates_ * (replicates_ - 1.0)) : 0.0;
    }

    const LightState& light_;
    std::uint32_t replicates_;
    std::vector<Gathered> gathered_;
    std::vector<double> square_, arriving_;  ///< sum n_ij v_ij^2 and sum n_ij B_j
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
