/// Closure: exchange areas from pooled ray counts such that every row is exact.
///
/// Patch i (area A_i, m2) sent N_i rays; n_ij of them ended on the front of j, o_i left into the open or ended on a
/// back. Pooled both ways, c_ij = n_ij + n_ji. The most likely exchange areas G = G^T >= 0 whose rows, with the open
/// share, are the patches' areas (multinomial likelihood, multipliers mu_i in rays/m2) are
///     G_ij = c_ij / (mu_i + mu_j),  G_ii = n_ii / mu_i,  open area = o_i / mu_i,  sum_j G_ij + o_i / mu_i = A_i.
///
/// Derivation: maximise sum_{i<j} c_ij log G_ij + sum_i (n_ii log G_ii + o_i log open_i) with the rows fixed. The
/// multipliers solve the dual: the least value of the convex function
///     D(mu) = sum_i A_i mu_i - sum_{i<j} c_ij log(mu_i + mu_j) - sum_i (n_ii + o_i) log mu_i   over mu >= 0,
/// with dD/dmu_i = A_i - row_i. It always exists, and G is unique. mu_i >= 0 belongs to it because G_ii without a self-hit costs the likelihood
/// nothing: where mu_i = 0, row_i <= A_i, and the rest of the row is G_ii. Such a row is *short*: the counts allow no
/// exact one (say a patch that the others' rays cannot find where its own start). It is recognised by mu_i at its
/// lowest value, counted and its rest measured; more steps would not help.
///
/// Start mu_i = N_i / A_i (the unconstrained Poisson estimate); each pass over the counts yields all rows and their
/// slopes, from which closure_step.h takes the next mu. The pass with the smallest mean row error is the one that
/// counts. What is left of its rows goes to G_ii, so rows are exact in double whatever the number of passes.
///
/// Memory: 24 doubles per patch, plus one batch of decoded blocks' row sums. Reads: iterations + 1 passes over the
/// counts, one block per thread at a time. Threads: the result does not depend on their number. Errors:
/// Error{damaged_store} for counts between patches that sent no rays; Error{internal} for sizes that do not fit.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "baker/formfactors/block_source.h"
#include "baker/formfactors/exchange_area.h"

namespace luxel {

/// A decoded block of pooled counts, laid out as Block: compressed rows, ascending columns, row < column when a == b.
struct CountBlock {
    ChunkNumber a = 0, b = 0;
    std::vector<std::uint32_t> row_begin;  ///< size(a) + 1
    std::vector<std::uint16_t> columns;    ///< patch number minus first_patch[b]
    std::vector<std::uint32_t> counts;     ///< c_ij = n_ij + n_ji > 0
};

/// Where pooled counts come from: the store's strips, or memory.
class CountSource {
  public:
    virtual ~CountSource() = default;
    [[nodiscard]] virtual const ChunkLayout& layout() const = 0;
    [[nodiscard]] virtual std::size_t block_count() const = 0;
    /// Decodes block `index`; blocks may come in any order that is the same every time. Threads: reentrant.
    virtual void load(std::size_t index, CountBlock& out) const = 0;
};

/// Per patch, in patch order.
struct ClosureInput {
    std::span<const double> area_m2;           ///< > 0
    std::span<const std::uint64_t> rays;       ///< N_i; 0 allowed
    std::span<const std::uint64_t> self_hits;  ///< n_ii, rays of i that ended on i's own front
    std::span<const std::uint64_t> open_hits;  ///< o_i
};

struct ClosureOptions {
    std::uint32_t iterations = 16;  ///< at most; 0 leaves the plain pooled estimate (with exact rows)
    double tolerance = 1e-9;        ///< stop when the largest row error is below
};

/// Row errors are |row sum - A_i| / A_i, self and open share included, remainder not; patches without evidence and short
/// rows excluded.
struct ClosureReport {
    std::uint32_t iterations = 0;  ///< steps that were made; one pass over the counts more
    double max_row_error_before = 0, mean_row_error_before = 0;
    double max_row_error_after = 0, mean_row_error_after = 0;
    double diagonal_share = 0;   ///< sum |G_ii| / sum A_i
    double remainder_share = 0;  ///< sum |what was moved to the diagonal to make rows exact| / sum A_i
    std::uint64_t short_rows = 0;  ///< rows that no multiplier can fill, by more than 1e-6 of their area
    double short_share = 0;        ///< what they lack / sum A_i; part of the remainder
    double largest_change = 0;     ///< of mu_i against N_i / A_i, relative; short rows excluded
    double mean_change = 0;        ///< the same, weighted by area
};

struct Closure {
    std::vector<double> mu;           ///< rays/m2; what exchange_area() takes
    std::vector<double> diagonal_m2;  ///< G_ii; slightly negative where the row was too long
    std::vector<double> row_open_m2;  ///< A_i minus the whole row: what the patch sends into the open or onto backs
    ClosureReport report;
};

/// A patch without rays of its own keeps what the others found of it; the rest of its row is taken as open.
Closure close_rows(const CountSource& counts, const ClosureInput& input, const ClosureOptions& options = {});

}  // namespace luxel
