#include "baker/solver/gather.h"

#include <algorithm>
#include <cmath>

#include "baker/core/parallel.h"
#include "baker/solver/certified_solver.h"
#include "baker/solver/inner_solve.h"
#include "baker/solver/whole_read.h"

namespace luxel {
namespace {

/// Pairs of a strip that stay decoded between its gathering and its scattering, 12 MB; blocks beyond are read twice.
constexpr std::uint64_t most_panel_pairs = 2'000'000;

class Jacobi final : public CertifiedSolver {
  public:
    explicit Jacobi(SolveFrame& frame) : CertifiedSolver(frame, {4 * frame.patch_count()}), sent_(frame.patch_count()) {
        if (const auto own = take_own_numbers()) from_numbers((*own)[0], sent_);
    }

    SolveResult run() {
        while (!frame_.is_done(error_bound(), *this) && frame_.may_read(frame_.total_bytes())) sweep();
        return frame_.finish(*this);
    }

  private:
    [[nodiscard]] std::vector<std::vector<double>> own_numbers() const override { return {to_numbers(sent_)}; }
    [[nodiscard]] double radiosity(PatchNumber i, std::size_t c) const {
        return frame_.emitted(i, c) + transport_.scaled_reflectance(i)[c] * irradiance_[i][c];
    }
    double error_bound() {
        ErrorSums sums;
        for (PatchNumber i = 0; i < sent_.size(); ++i)
            for (std::size_t c = 0; c < 3; ++c) {
                unshot_[i][c] = radiosity(i, c) - sent_[i].v[c];
                sums.add(c, transport_.area_m2(i), adjoint_.weight(i)[c], unshot_[i][c], radiosity(i, c));
            }
        return sums.bound(frame_.emitted_power());
    }
    void sweep() {
        for (PatchNumber i = 0; i < sent_.size(); ++i)
            sent_[i] = {{radiosity(i, 0), radiosity(i, 1), radiosity(i, 2), 1}};
        const std::vector<Lanes> exchange = exchange_everywhere(transport_, sent_);
        if (!adjoint_.hold_for(transport_, 0, exchange)) adjoint_.certify_by_reads(transport_, frame_.emits());
        for (PatchNumber i = 0; i < sent_.size(); ++i)
            for (std::size_t c = 0; c < 3; ++c) irradiance_[i][c] = exchange[i].v[c] / transport_.area_m2(i);
    }

    std::vector<Lanes> sent_;  ///< of the last sweep; 1 in the spare lane, which yields row sums
};

class Gatherer final : public CertifiedSolver {
  public:
    explicit Gatherer(SolveFrame& frame)
        : CertifiedSolver(frame, {4 * frame.patch_count()}),
          radiosity_(frame.patch_count()),
          below_(frame.patch_count()) {
        if (const auto own = take_own_numbers()) {
            from_numbers((*own)[0], radiosity_);
            return;
        }
        // Before the first sweep nobody has received anything.
        for (PatchNumber i = 0; i < radiosity_.size(); ++i) {
            for (std::size_t c = 0; c < 3; ++c) radiosity_[i].v[c] = unshot_[i][c] = frame.emitted(i, c);
            radiosity_[i].v[3] = 1;
        }
    }

    SolveResult run() {
        while (!frame_.is_done(error_bound(), *this) && frame_.may_read(2 * frame_.total_bytes()))
            for (ChunkNumber chunk = 0; chunk < transport_.layout().chunk_count(); ++chunk) strip(chunk);
        return frame_.finish(*this);
    }

  private:
    [[nodiscard]] std::vector<std::vector<double>> own_numbers() const override { return {to_numbers(radiosity_)}; }
    /// Unshot is what has changed in the sweep.
    double error_bound() {
        ErrorSums sums;
        for (PatchNumber i = 0; i < radiosity_.size(); ++i)
            for (std::size_t c = 0; c < 3; ++c) {
                const double weight = transport_.area_m2(i) * adjoint_.weight(i)[c];
                const double rest =
                    frame_.emitted(i, c) + transport_.scaled_reflectance(i)[c] * irradiance_[i][c] - radiosity_[i].v[c];
                sums.add(c, transport_.area_m2(i), adjoint_.weight(i)[c], unshot_[i][c], radiosity_[i].v[c]);
                // The rest may be of either sign beside the change.
                sums.weighted[c] += weight * std::abs(rest);
                sums.negative[c] += weight * std::abs(rest);
            }
        power_ = sums.power;
        return sums.bound(frame_.emitted_power());
    }

    void strip(ChunkNumber chunk) {
        const PatchNumber first = transport_.first(chunk);
        const std::size_t count = transport_.size(chunk);
        std::vector<RowBlock> behind;
        for (const RowBlock& block : transport_.row(chunk))
            if (block.is_a) behind.push_back(block);
        std::vector<std::shared_ptr<const Block>> panel(behind.size());
        const std::vector<Lanes> gathered = gather_along(chunk, behind, panel);
        const std::shared_ptr<const Block> diagonal = transport_.load_diagonal(chunk);
        const ChunkSystem system(transport_, chunk, diagonal.get());
        std::vector<Lanes> solved = solve_gathered(system, gathered), exchange;
        for (Lanes& of_patch : solved) of_patch.v[3] = 1;
        system.multiply(solved, exchange);
        for (std::size_t i = 0; i < count; ++i) {
            const PatchNumber patch = first + static_cast<PatchNumber>(i);
            for (std::size_t c = 0; c < 4; ++c) exchange[i].v[c] += gathered[i].v[c];
            for (std::size_t c = 0; c < 3; ++c) {
                irradiance_[patch][c] = exchange[i].v[c] / transport_.area_m2(patch);
                unshot_[patch][c] = solved[i].v[c] - radiosity_[patch].v[c];
            }
        }
        if (!adjoint_.hold_for(transport_, first, exchange)) adjoint_.certify_by_reads(transport_, frame_.emits());
        std::copy(solved.begin(), solved.end(), radiosity_.begin() + first);
        parallel_for(behind.size(), 1, [&](std::size_t k) {
            const std::shared_ptr<const Block> block = panel[k] ? panel[k] : transport_.load(behind[k].index);
            scatter_columns(*block, solved, of_chunk(below_, behind[k].other));
        });
    }

    std::span<Lanes> of_chunk(std::vector<Lanes>& all, ChunkNumber chunk) const {
        return std::span(all).subspan(transport_.first(chunk), transport_.size(chunk));
    }

    /// What the chunk receives from the others: from those before it by their scatter, from those behind it along the
    /// strip. `panel`: the blocks of the strip that stay in memory for its scatter.
    std::vector<Lanes> gather_along(ChunkNumber chunk, std::span<const RowBlock> behind,
                                    std::span<std::shared_ptr<const Block>> panel) {
        std::uint64_t pairs = 0;
        std::size_t kept = 0;
        while (kept < behind.size() &&
               (pairs += transport_.blocks()[behind[kept].index].pair_count) <= most_panel_pairs)
            ++kept;
        const std::span<Lanes> from_before = of_chunk(below_, chunk);
        std::vector<Lanes> gathered(from_before.begin(), from_before.end());
        std::fill(from_before.begin(), from_before.end(), Lanes{});
        std::vector<std::vector<Lanes>> parts(transport_batch_blocks);
        for (std::size_t first = 0; first < behind.size(); first += transport_batch_blocks) {
            const std::size_t batch = std::min(transport_batch_blocks, behind.size() - first);
            parallel_for(batch, 1, [&](std::size_t k) {
                const std::shared_ptr<const Block> block = transport_.load(behind[first + k].index);
                parts[k].assign(gathered.size(), Lanes{});
                gather_rows(*block, of_chunk(radiosity_, behind[first + k].other), parts[k]);
                if (first + k < kept) panel[first + k] = block;
            });
            for (std::size_t k = 0; k < batch; ++k)
                for (std::size_t i = 0; i < gathered.size(); ++i)
                    for (std::size_t c = 0; c < 4; ++c) gathered[i].v[c] += parts[k][i].v[c];
        }
        return gathered;
    }

    /// X = M' + rho' gathered / A + K_aa X. From the radiosity of the sweep before: where little has arrived since,
    /// nothing changes at all.
    std::vector<Lanes> solve_gathered(const ChunkSystem& system, std::span<const Lanes> gathered) {
        const PatchNumber first = transport_.first(system.chunk());
        std::vector<Lanes> arriving(gathered.size());
        for (std::size_t i = 0; i < gathered.size(); ++i)
            for (std::size_t c = 0; c < 3; ++c) {
                const PatchNumber patch = first + static_cast<PatchNumber>(i);
                arriving[i].v[c] = frame_.emitted(patch, c) + transport_.scaled_reflectance(patch)[c] *
                                                                  gathered[i].v[c] / transport_.area_m2(patch);
            }
        return solve_inside(
            transport_, adjoint_, system, arriving, of_chunk(radiosity_, system.chunk()),
            {unnoticed_rest(frame_.options().tolerance, power_, transport_.layout().chunk_count()), inner_share});
    }

    std::vector<Lanes> radiosity_;  ///< x; 1 in the spare lane, which yields row sums
    std::vector<Lanes> below_;      ///< sum of G_ij x_j over the chunks before, of this sweep
    Channels power_{0, 0, 0};
};

}  // namespace

SolveResult solve_by_jacobi(BlockSource& source, const SolveInput& input, const SolveOptions& options) {
    SolveFrame frame(source, input, options, "jacobi");
    if (frame.is_trivial()) return frame.trivial_result();
    return Jacobi(frame).run();
}

SolveResult solve_by_gathering(BlockSource& source, const SolveInput& input, const SolveOptions& options) {
    SolveFrame frame(source, input, options, "gather");
    if (frame.is_trivial()) return frame.trivial_result();
    return Gatherer(frame).run();
}

}  // namespace luxel
