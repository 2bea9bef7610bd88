/// Closure: exchange areas from pooled ray counts such that every row is exact.
///
/// Patch i (area A_i, m2) sent N_i rays; n_ij of them ended on the front of j, o_i left into the open or ended on a
/// back. Pooled both ways, c_ij = n_ij + n_ji. The most likely exchange areas under the condition that each row, with
/// its open share, is the patch's area (multinomial likelihood, one multiplier mu_i in rays/m2 per patch) are
///     G_ij = c_ij / (mu_i + mu_j),   open area = o_i / mu_i,   sum_j G_ij + o_i / mu_i = A_i,   c_ii = 2 n_ii.
/// Start mu_i = N_i / A_i (which is the unconstrained Poisson estimate), iterate mu_i *= row_i / A_i. What is left
/// after the last iteration goes to G_ii, so rows are exact in double whatever the number of iterations. Derivation:
/// maximise sum c_ij log G_ij + sum o_i log open_i over G = G^T with the row sums fixed; mu are the multipliers.
///
/// Memory: 5 doubles per patch, plus one batch of decoded blocks' row sums. Reads: iterations + 1 passes over the
/// counts, one block per thread at a time. Threads: the result does not depend on their number. Errors:
/// Error{damaged_store} for counts between patches that sent no rays; Error{internal} for sizes that do not fit.
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "baker/formfactors/block_source.h"

namespace luxel {

/// The one place where a count becomes an exchange area in m2. The reader of the store and closure both call it, so
/// that they see the same float. Symmetric in i and j. count > 0, mu_i + mu_j > 0; the result is a positive normal
/// float.
inline float exchange_area(std::uint32_t count, double mu_i, double mu_j) {
    const double area_m2 = static_cast<double>(count) / (mu_i + mu_j);
    return static_cast<float>(std::max(area_m2, static_cast<double>(std::numeric_limits<float>::min())));
}

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

/// Row errors are |row sum - A_i| / A_i, self and open share included, remainder not; patches without evidence
/// excluded.
struct ClosureReport {
    std::uint32_t iterations = 0;
    double max_row_error_before = 0, mean_row_error_before = 0;
    double max_row_error_after = 0, mean_row_error_after = 0;
    double diagonal_share = 0;   ///< sum |G_ii| / sum A_i
    double remainder_share = 0;  ///< sum |what was moved to the diagonal to make rows exact| / sum A_i
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
