#include "baker/formfactors/closure.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "baker/core/parallel.h"
#include "formats/base/error.h"

namespace luxel {

namespace {

/// Blocks whose row sums are held at the same time, m2 each. Fixed, so that memory and result do not depend on threads.
constexpr std::size_t batch_blocks = 32;

/// Row sums that one block contributes to the rows of a and to those of b.
struct BlockSums {
    ChunkNumber a = 0, b = 0;
    std::vector<double> rows_a, rows_b;
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
    const double* const mu_a = mu.data() + layout.first_patch[block.a];
    const double* const mu_b = mu.data() + layout.first_patch[block.b];
    for (std::size_t row = 0; row + 1 < block.row_begin.size(); ++row) {
        double sum = 0;
        for (std::size_t k = block.row_begin[row]; k < block.row_begin[row + 1]; ++k) {
            const std::size_t column = block.columns[k];
            const double area_m2 = exchange_area(block.counts[k], mu_a[row], mu_b[column]);
            sum += area_m2;
            out.rows_b[column] += area_m2;
        }
        out.rows_a[row] += sum;
    }
}

/// One pass over the counts: sum over j != i of G_ij. Partial sums per block are added in block order, so the result is
/// the same for any number of threads.
std::vector<double> pair_row_sums(const CountSource& counts, std::span<const double> mu) {
    const ChunkLayout& layout = counts.layout();
    std::vector<double> rows(layout.patch_count(), 0.0);
    std::vector<BlockSums> sums(batch_blocks);
    const auto add = [&](ChunkNumber chunk, const std::vector<double>& part) {
        double* const target = rows.data() + layout.first_patch[chunk];
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
            add(sums[k].a, sums[k].rows_a);
            add(sums[k].b, sums[k].rows_b);
        }
    }
    return rows;
}

/// What of row i does not depend on other patches, m2: n_ii / mu_i and o_i / mu_i. No rays, no share.
double ratio(std::uint64_t hits, double mu) { return hits == 0 || mu <= 0 ? 0.0 : static_cast<double>(hits) / mu; }

struct RowErrors {
    double largest = 0, mean = 0;
};

RowErrors row_errors(const ClosureInput& input, std::span<const double> rows) {
    RowErrors errors;
    std::size_t count = 0;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        if (input.rays[i] == 0 || rows[i] <= 0) continue;
        const double error = std::abs(rows[i] - input.area_m2[i]) / input.area_m2[i];
        errors.largest = std::max(errors.largest, error);
        errors.mean += error;
        ++count;
    }
    if (count > 0) errors.mean /= static_cast<double>(count);
    return errors;
}

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

void update(const ClosureInput& input, std::span<const double> rows, double mean_density, std::vector<double>& mu) {
    for (std::size_t i = 0; i < mu.size(); ++i) {
        if (rows[i] <= 0) continue;
        const double relative = rows[i] / input.area_m2[i];
        if (mu[i] > 0) {
            // Without rays of its own a row is only limited from above: its multiplier falls towards 0 where the row is
            // short.
            mu[i] *= relative;
        } else if (relative > 1) {
            // The others find more of it than it has: the limit binds, so the multiplier becomes positive.
            mu[i] = mean_density * (relative - 1);
        }
    }
}

/// Splits what is left of each row: to the diagonal where the patch has evidence, into the open where it has none.
void finish(const ClosureInput& input, std::span<const double> pairs, std::span<const double> rows, Closure& closure) {
    const std::size_t count = pairs.size();
    closure.diagonal_m2.assign(count, 0.0);
    closure.row_open_m2.assign(count, 0.0);
    double area_sum = 0, diagonal_sum = 0, remainder_sum = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const double open_m2 = ratio(input.open_hits[i], closure.mu[i]);
        const double rest_m2 = input.area_m2[i] - pairs[i] - open_m2;
        const bool has_evidence = input.rays[i] > 0 && rows[i] > 0;
        if (has_evidence || rest_m2 < 0) {
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
    const std::size_t count = input.area_m2.size();
    Closure closure;
    closure.mu.resize(count);
    double ray_sum = 0, area_sum = 0;
    for (std::size_t i = 0; i < count; ++i) {
        closure.mu[i] = static_cast<double>(input.rays[i]) / input.area_m2[i];
        ray_sum += static_cast<double>(input.rays[i]);
        area_sum += input.area_m2[i];
    }
    const double mean_density = area_sum > 0 ? ray_sum / area_sum : 0.0;
    ClosureReport& report = closure.report;
    for (;;) {
        const std::vector<double> pairs = pair_row_sums(counts, closure.mu);
        const std::vector<double> rows = whole_rows(input, pairs, closure.mu);
        const RowErrors errors = row_errors(input, rows);
        if (report.iterations == 0) {
            report.max_row_error_before = errors.largest;
            report.mean_row_error_before = errors.mean;
        }
        if (report.iterations == options.iterations || errors.largest < options.tolerance) {
            report.max_row_error_after = errors.largest;
            report.mean_row_error_after = errors.mean;
            finish(input, pairs, rows, closure);
            return closure;
        }
        update(input, rows, mean_density, closure.mu);
        ++report.iterations;
    }
}

}  // namespace luxel
