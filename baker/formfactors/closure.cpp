#include "baker/formfactors/closure.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "baker/core/parallel.h"
#include "baker/formfactors/closure_step.h"
#include "formats/base/error.h"

namespace luxel {

namespace {

/// Blocks whose row sums are held at the same time, m2 each. Fixed, so that memory and result do not depend on threads.
constexpr std::size_t batch_blocks = 32;

/// mu never falls below this part of N_i / A_i: a row there is short, or too short by no more than this. It keeps two
/// patches that see only each other from vanishing together.
constexpr double lowest_part = 1e-6;

/// What one block contributes to the rows of a and to those of b, and to their slopes.
struct BlockSums {
    ChunkNumber a = 0, b = 0;
    std::vector<double> rows_a, rows_b, slopes_a, slopes_b;
};

void check(const CountSource& counts, const ClosureInput& input) {
    const std::size_t count = counts.layout().patch_count();
    if (input.area_m2.size() != count || input.rays.size() != count || input.self_hits.size() != count ||
        input.open_hits.size() != count)
        throw Error(ErrorCode::internal, "closure", "areas, rays, self hits and open hits need one entry per patch");
}

void sum_block(const CountBlock& block, const ChunkLayout& layout, std::span<const double> mu, BlockSums& out) {
    out.a = block.a;
    out.b = block.b;
    out.rows_a.assign(layout.size(block.a), 0.0);
    out.rows_b.assign(layout.size(block.b), 0.0);
    out.slopes_a.assign(layout.size(block.a), 0.0);
    out.slopes_b.assign(layout.size(block.b), 0.0);
    const double* const mu_a = mu.data() + layout.first_patch[block.a];
    const double* const mu_b = mu.data() + layout.first_patch[block.b];
    for (std::size_t row = 0; row + 1 < block.row_begin.size(); ++row) {
        double sum = 0, slope_sum = 0;
        for (std::size_t k = block.row_begin[row]; k < block.row_begin[row + 1]; ++k) {
            const std::size_t column = block.columns[k];
            const double area_m2 = exchange_area(block.counts[k], mu_a[row], mu_b[column]);
            const double slope = area_m2 / (mu_a[row] + mu_b[column]);
            sum += area_m2;
            slope_sum += slope;
            out.rows_b[column] += area_m2;
            out.slopes_b[column] += slope;
        }
        out.rows_a[row] += sum;
        out.slopes_a[row] += slope_sum;
    }
}

/// One pass over the counts. Partial sums per block are added in block order, so the result is the same for any number
/// of threads.
RowState pass(const CountSource& counts, std::span<const double> mu) {
    const ChunkLayout& layout = counts.layout();
    RowState rows{std::vector<double>(layout.patch_count(), 0.0), std::vector<double>(layout.patch_count(), 0.0)};
    std::vector<BlockSums> sums(batch_blocks);
    const auto add = [&](std::vector<double>& to, ChunkNumber chunk, const std::vector<double>& part) {
        double* const target = to.data() + layout.first_patch[chunk];
        for (std::size_t i = 0; i < part.size(); ++i) target[i] += part[i];
    };
    for (std::size_t first = 0; first < counts.block_count(); first += batch_blocks) {
        const std::size_t batch = std::min(batch_blocks, counts.block_count() - first);
        parallel_for(batch, 1, [&](std::size_t k) {
            CountBlock block;
            counts.load(first + k, block);
            sum_block(block, layout, mu, sums[k]);
        });
        for (std::size_t k = 0; k < batch; ++k) {
            add(rows.pairs_m2, sums[k].a, sums[k].rows_a);
            add(rows.pairs_m2, sums[k].b, sums[k].rows_b);
            add(rows.slope, sums[k].a, sums[k].slopes_a);
            add(rows.slope, sums[k].b, sums[k].slopes_b);
        }
    }
    return rows;
}

/// What of row i does not depend on other patches, m2: n_ii / mu_i and o_i / mu_i. No rays, no share.
double ratio(std::uint64_t hits, double mu) { return hits == 0 || mu <= 0 ? 0.0 : static_cast<double>(hits) / mu; }

/// pairs[i] -> whole row i, with self and open share.
std::vector<double> whole_rows(const ClosureInput& input, std::span<const double> pairs, std::span<const double> mu) {
    std::vector<double> rows(pairs.begin(), pairs.end());
    for (std::size_t i = 0; i < rows.size(); ++i) {
        rows[i] += ratio(input.self_hits[i], mu[i]) + ratio(input.open_hits[i], mu[i]);
        if (!std::isfinite(rows[i]))
            throw Error(ErrorCode::damaged_store, "closure, patch " + std::to_string(i),
                        "counts between patches that sent no rays",
                        "the evidence is damaged; remove it from the bake folder and bake again");
    }
    return rows;
}

/// What closure knows after a pass.
struct Pass {
    std::vector<double> mu, pairs_m2, rows_m2;
    double largest_error = 0, mean_error = 0;
};

/// One per patch, in patch order.
struct Limits {
    std::vector<double> start, lowest, fixed;
};

Limits limits(const ClosureInput& input) {
    Limits all;
    for (std::size_t i = 0; i < input.area_m2.size(); ++i) {
        all.start.push_back(static_cast<double>(input.rays[i]) / input.area_m2[i]);
        all.lowest.push_back(lowest_part * all.start.back());
        all.fixed.push_back(static_cast<double>(input.self_hits[i]) + static_cast<double>(input.open_hits[i]));
    }
    return all;
}

bool has_evidence(const ClosureInput& input, const Pass& pass, std::size_t i) {
    return input.rays[i] > 0 && pass.rows_m2[i] > 0;
}

bool is_short(const ClosureInput& input, const Limits& limits, const Pass& pass, std::size_t i) {
    return pass.mu[i] <= limits.lowest[i] && pass.rows_m2[i] < input.area_m2[i];
}

void measure(const ClosureInput& input, const Limits& limits, Pass& pass) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < pass.mu.size(); ++i) {
        if (!has_evidence(input, pass, i) || is_short(input, limits, pass, i)) continue;
        const double error = std::abs(pass.rows_m2[i] - input.area_m2[i]) / input.area_m2[i];
        pass.largest_error = std::max(pass.largest_error, error);
        pass.mean_error += error;
        ++count;
    }
    if (count > 0) pass.mean_error /= static_cast<double>(count);
}

/// What was found and changed, as shares of all area.
void report_changes(const ClosureInput& input, const Limits& limits, const Pass& pass, ClosureReport& report) {
    double area_sum = 0, weight = 0;
    for (std::size_t i = 0; i < pass.mu.size(); ++i) {
        area_sum += input.area_m2[i];
        if (!has_evidence(input, pass, i)) continue;
        if (is_short(input, limits, pass, i)) {
            const double lacking_m2 = input.area_m2[i] - pass.rows_m2[i];
            report.short_rows += lacking_m2 > lowest_part * input.area_m2[i] ? 1 : 0;
            report.short_share += lacking_m2;
        } else {
            const double change = std::abs(pass.mu[i] / limits.start[i] - 1);
            report.largest_change = std::max(report.largest_change, change);
            report.mean_change += change * input.area_m2[i];
            weight += input.area_m2[i];
        }
    }
    if (area_sum > 0) report.short_share /= area_sum;
    if (weight > 0) report.mean_change /= weight;
}

/// Splits what is left of each row: to the diagonal where the patch has evidence, into the open where it has none.
void finish(const ClosureInput& input, const Pass& pass, Closure& closure) {
    const std::size_t count = pass.mu.size();
    closure.mu = pass.mu;
    closure.diagonal_m2.assign(count, 0.0);
    closure.row_open_m2.assign(count, 0.0);
    double area_sum = 0, diagonal_sum = 0, remainder_sum = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const double open_m2 = ratio(input.open_hits[i], closure.mu[i]);
        const double rest_m2 = input.area_m2[i] - pass.pairs_m2[i] - open_m2;
        if (has_evidence(input, pass, i) || rest_m2 < 0) {
            closure.diagonal_m2[i] = rest_m2;
            closure.row_open_m2[i] = open_m2;
            remainder_sum += std::abs(rest_m2 - ratio(input.self_hits[i], closure.mu[i]));
        } else {
            closure.row_open_m2[i] = open_m2 + rest_m2;
        }
        area_sum += input.area_m2[i];
        diagonal_sum += std::abs(closure.diagonal_m2[i]);
    }
    if (area_sum > 0) {
        closure.report.diagonal_share = diagonal_sum / area_sum;
        closure.report.remainder_share = remainder_sum / area_sum;
    }
}

}  // namespace

Closure close_rows(const CountSource& counts, const ClosureInput& input, const ClosureOptions& options) {
    flush_denormals();
    check(counts, input);
    const Limits all = limits(input);
    ClosureSteps steps(input.area_m2, all.fixed, all.lowest);
    std::vector<double> mu = all.start;
    Closure closure;
    Pass best;
    for (std::uint32_t iteration = 0;; ++iteration) {
        RowState rows = pass(counts, mu);
        Pass now{mu, rows.pairs_m2, whole_rows(input, rows.pairs_m2, mu)};
        measure(input, all, now);
        if (iteration == 0) {
            closure.report.max_row_error_before = now.largest_error;
            closure.report.mean_row_error_before = now.mean_error;
        }
        closure.report.iterations = iteration;
        const bool done = iteration == options.iterations || now.largest_error < options.tolerance;
        if (iteration == 0 || now.mean_error < best.mean_error) best = std::move(now);
        if (done) break;
        steps.advance(rows, mu);
    }
    closure.report.max_row_error_after = best.largest_error;
    closure.report.mean_row_error_after = best.mean_error;
    report_changes(input, all, best, closure.report);
    finish(input, best, closure);
    return closure;
}

}  // namespace luxel
