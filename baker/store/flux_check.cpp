#include "baker/store/flux_check.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "baker/store/probability.h"

namespace luxel {
namespace {

/// A quarter of the correlation that the first test assumes between patches: neighbours share a border, and what one sees
/// more of there the other sees less of. Halves the number of independent differences; measured in tests.
constexpr double shared_share = 2;

/// Sums of one pass.
class FluxSums {
  public:
    FluxSums(const FluxInput& input, std::uint32_t replicates)
        : input_(input), replicates_(replicates), difference_(input.ids.size() * replicates), in_(input.ids.size()),
          poisson_(input.ids.size()), own_rays_(input.ids.size()), others_rays_(input.ids.size()) {}

    void add(const NumberedEvidence& e) {
        for (std::size_t r = 0; r < e.block.rows.size(); ++r) add_row(e, r);
    }

    [[nodiscard]] std::uint32_t replicates() const { return replicates_; }
    /// Difference of one replicate, m2.
    [[nodiscard]] double difference(std::size_t p, std::uint32_t r) const {
        return difference_[p * replicates_ + r] * replicates_;
    }
    [[nodiscard]] double mean(std::size_t p) const {
        double sum = 0;
        for (std::uint32_t r = 0; r < replicates_; ++r) sum += difference_[p * replicates_ + r];
        return sum;
    }
    /// Variance of the mean from the replicates.
    [[nodiscard]] double variance(std::size_t p) const {
        const double middle = mean(p);
        double sum = 0;
        for (std::uint32_t r = 0; r < replicates_; ++r) sum += std::pow(difference(p, r) - middle, 2);
        return sum / replicates_ / (replicates_ - 1);
    }
    /// Variance of the mean if every ray were independent of the others: of all pairs, less what the fixed number of own
    /// rays takes away.
    [[nodiscard]] double poisson(std::size_t p) const {
        const double out = in_[p] + mean(p), fixed = out * out / input_.rays[p];
        return std::max(poisson_[p] - fixed, 0.05 * poisson_[p]);
    }
    [[nodiscard]] double in(std::size_t p) const { return in_[p]; }
    /// Rays to be expected of the side that has fewer, by what both sides together have found. The pooled estimate has no
    /// correlation with the difference of the two: choosing patches by it prefers no result.
    [[nodiscard]] double base(std::size_t p) const { return std::min(own_rays_[p], others_rays_[p]); }

  private:
    void add_row(const NumberedEvidence& e, std::size_t index) {
        const EvidenceBlock::Row& row = e.block.rows[index];
        const PatchNumber i = e.patches[index];
        if (row.replicate >= replicates_)
            throw Error(ErrorCode::damaged_store, e.where, "replicate " + std::to_string(row.replicate) + ", the first block has " +
                                                               std::to_string(replicates_), "remove the file and bake again");
        const double per_ray = input_.rays[i] ? input_.area_m2[i] / input_.rays[i] : 0;  // m2
        double hits = 0, own_rays = 0, others_rays = 0;
        for (std::uint32_t k = row.first; k < row.first + row.count; ++k) {
            const PatchNumber j = e.targets[e.block.target_index[k]];
            if (j == i || input_.rays[j] == 0) continue;
            const double n = e.block.counts[k], variance = n * per_ray * input_.area_m2[j] / input_.rays[j];
            const double share = 1 / (1 + per_ray * input_.rays[j] / input_.area_m2[j]);  // of i's rays among both
            hits += n;
            own_rays += n * share;
            others_rays += n * (1 - share);
            own_rays_[j] += n * (1 - share);
            others_rays_[j] += n * share;
            difference_[std::size_t{j} * replicates_ + row.replicate] -= per_ray * n;
            in_[j] += per_ray * n;
            poisson_[i] += variance;
            poisson_[j] += variance;
        }
        difference_[std::size_t{i} * replicates_ + row.replicate] += per_ray * hits;
        own_rays_[i] += own_rays;
        others_rays_[i] += others_rays;
    }

    const FluxInput& input_;
    std::uint32_t replicates_;
    std::vector<double> difference_;  ///< per patch and replicate: its part of the mean
    std::vector<double> in_, poisson_;
    std::vector<double> own_rays_, others_rays_;  ///< pooled: own rays that meet others, rays of others that meet the patch
};

std::uint32_t replicates_in(const NumberedEvidence& e) {
    std::uint32_t most = 0;
    for (const EvidenceBlock::Row& row : e.block.rows) most = std::max<std::uint32_t>(most, row.replicate + 1u);
    return most;
}

/// How the scatter over replicates relates to the Poisson variance: variance_i ~ share * poisson_i * chi-square(R - 1) *
/// inverse-chi-square(prior).
struct ScatterModel {
    double share = 1, prior = 0;
};

ScatterModel fit_scatter(const FluxSums& sums, std::span<const PatchNumber> tested) {
    const double freedom = sums.replicates() - 1.0;
    double sum = 0, square = 0, count = 0;
    for (const PatchNumber p : tested) {
        const double variance = sums.variance(p);
        if (!(variance > 0)) continue;
        const double e = std::log(variance / sums.poisson(p)) - digamma(freedom / 2) + std::log(freedom / 2);
        sum += e, square += e * e, count += 1;
    }
    if (count < 2) return {};
    const double mean = sum / count, spread = (square - sum * mean) / (count - 1) - trigamma(freedom / 2);
    constexpr double most = 60;  // rare events have longer tails than a normal variable: never quite believed
    ScatterModel model;
    model.prior = spread > trigamma(most / 2) ? 2 * inverse_trigamma(spread) : most;
    model.share = std::exp(mean + digamma(model.prior / 2) - std::log(model.prior / 2));
    return model;
}

double all_patches(const FluxSums& sums, const FluxInput& input, std::span<const PatchNumber> tested,
                   const FluxOptions& options) {
    const std::uint32_t r_count = sums.replicates();
    double off = 0, within = 0, within_square = 0, allowed = 0;
    for (const PatchNumber p : tested) {
        const double weight = 1 / sums.poisson(p), mean = sums.mean(p);
        double own = 0;
        for (std::uint32_t r = 0; r < r_count; ++r) own += sums.difference(p, r) * sums.difference(p, r);
        // Sum over r != s of d^r d^s, divided by the number of such pairs.
        const double total = mean * r_count;
        off += weight * (total * total - own) / (r_count * (r_count - 1.0));
        const double variance = weight * r_count * sums.variance(p);
        within += variance;
        within_square += variance * variance;
        allowed += weight * std::pow(options.allowance * input.area_m2[p], 2);
    }
    if (!(within > 0)) return 1;
    // The squares of estimated variances are larger than the squares of true ones: E[x^2] = x^2 (1 + 2 / (R - 1)).
    within_square /= 1 + 2 / (r_count - 1.0);
    const double deviation = std::sqrt(2 / (r_count * (r_count - 1.0)) * shared_share * within_square);
    return 0.5 * std::erfc((off - allowed) / deviation / std::sqrt(2.0));
}

FluxSuspect examine(const FluxSums& sums, const FluxInput& input, PatchNumber p, const ScatterModel& model,
                    const FluxOptions& options) {
    FluxSuspect s{p, input.ids[p], sums.in(p) + sums.mean(p), sums.in(p), 0, 0};
    const double freedom = sums.replicates() - 1.0, prior = model.share * sums.poisson(p);
    const double variance = freedom > 0 ? (model.prior * prior + freedom * sums.variance(p)) / (model.prior + freedom) : prior;
    s.standard_error_m2 = std::sqrt(variance);
    const double beyond = std::max(0.0, std::abs(sums.mean(p)) - options.allowance * input.area_m2[p]);
    s.t = s.standard_error_m2 > 0 ? std::copysign(beyond / s.standard_error_m2, sums.mean(p)) : 0;
    return s;
}

FluxCheck judge(const FluxSums& sums, const FluxInput& input, const FluxOptions& options) {
    std::vector<PatchNumber> tested;
    FluxCheck check;
    double difference = 0, flux = 0;
    for (PatchNumber p = 0; p < input.ids.size(); ++p) {
        if (input.rays[p] == 0 || sums.base(p) < options.least_rays) {
            ++check.skipped;
            continue;
        }
        tested.push_back(p);
        difference += std::abs(sums.mean(p));
        flux += sums.in(p) + 0.5 * sums.mean(p);
    }
    check.patches = tested.size();
    check.replicates = sums.replicates();
    check.mean_difference = flux > 0 ? difference / flux : 0;
    const bool replicated = sums.replicates() > 1;
    const ScatterModel model = replicated ? fit_scatter(sums, tested) : ScatterModel{1, 60};
    check.scatter = model.share;
    check.freedom = model.prior + sums.replicates() - 1.0;
    for (const PatchNumber p : tested) check.worst.push_back(examine(sums, input, p, model, options));
    const std::size_t listed = std::min(options.worst, check.worst.size());
    std::partial_sort(check.worst.begin(), check.worst.begin() + static_cast<std::ptrdiff_t>(std::max<std::size_t>(listed, !tested.empty())),
                      check.worst.end(), [](const FluxSuspect& a, const FluxSuspect& b) {
                          return std::abs(a.t) != std::abs(b.t) ? std::abs(a.t) > std::abs(b.t) : a.patch < b.patch;
                      });
    if (!tested.empty())
        check.probability_each = std::min(
            1.0, static_cast<double>(tested.size()) * student_tail(std::abs(check.worst.front().t), check.freedom));
    check.worst.resize(listed);
    check.worst.shrink_to_fit();
    if (replicated) check.probability_all = all_patches(sums, input, tested, options);
    check.passed = 2 * std::min(check.probability_all, check.probability_each) >= options.false_alarm;
    return check;
}

}  // namespace

FluxCheck check_flux(const FluxInput& input, std::span<const EvidenceFile> files, const FluxOptions& options,
                     const ProgressFunction& progress) {
    if (input.area_m2.size() != input.ids.size() || input.rays.size() != input.ids.size())
        throw Error(ErrorCode::internal, "flux check", "ids, areas and rays need one entry per patch");
    const IdIndex ids(input.ids);
    std::unique_ptr<FluxSums> sums;
    read_evidence(files, ids, [&](const NumberedEvidence& block, std::size_t) {
        if (block.block.rows.empty()) return;
        if (!sums) sums = std::make_unique<FluxSums>(input, replicates_in(block));
        sums->add(block);
    }, progress);
    return sums ? judge(*sums, input, options) : FluxCheck{};
}

}  // namespace luxel
