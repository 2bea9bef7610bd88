#include "baker/solver/shoot_patch.h"

#include <algorithm>
#include <utility>

#include "baker/solver/certified_solver.h"

namespace luxel {
namespace {

/// Shots between two looks at the bound, as a share of all patches: a look costs as much as some shots.
constexpr double look_share = 0.01;

class PatchShooter final : public CertifiedSolver {
  public:
    explicit PatchShooter(SolveFrame& frame)
        : CertifiedSolver(frame, {}), brightest_(transport_.layout().chunk_count()) {
        if (!take_own_numbers()) begin_with_emission();
        for (ChunkNumber chunk = 0; chunk < brightest_.size(); ++chunk) find_brightest(chunk);
    }

    SolveResult run() {
        const auto shots = static_cast<std::size_t>(look_share * static_cast<double>(unshot_.size())) + 1;
        bool may_read = true;
        while (may_read && !frame_.is_done(error_bound(), *this))
            for (std::size_t shot = 0; may_read && shot < shots; ++shot) may_read = shoot();
        if (!may_read) frame_.is_done(error_bound(), *this);
        return frame_.finish(*this);
    }

  private:
    [[nodiscard]] std::vector<std::vector<double>> own_numbers() const override { return {}; }

    struct Brightest {
        PatchNumber patch = 0;
        double power = 0;  ///< A U over what is emitted, the largest channel
    };

    double error_bound() const {
        ErrorSums sums;
        for (PatchNumber i = 0; i < unshot_.size(); ++i)
            for (std::size_t c = 0; c < 3; ++c)
                sums.add(c, transport_.area_m2(i), adjoint_.weight(i)[c], unshot_[i][c],
                         frame_.emitted(i, c) + transport_.scaled_reflectance(i)[c] * irradiance_[i][c]);
        return sums.bound(frame_.emitted_power());
    }

    void find_brightest(ChunkNumber chunk) {
        Brightest best{transport_.first(chunk), 0};
        for (PatchNumber i = best.patch; i < transport_.layout().first_patch[chunk + 1]; ++i) {
            double power = 0;
            for (std::size_t c = 0; c < 3; ++c)
                if (frame_.emitted_power()[c] > 0)
                    power = std::max(power, transport_.area_m2(i) * unshot_[i][c] / frame_.emitted_power()[c]);
            if (power > best.power) best = {i, power};
        }
        brightest_[chunk] = best;
    }

    /// False: no more reads are allowed, or nothing is left.
    bool shoot() {
        const auto best = std::max_element(brightest_.begin(), brightest_.end(),
                                           [](const Brightest& a, const Brightest& b) { return a.power < b.power; });
        if (best == brightest_.end() || best->power == 0) return false;
        const auto chunk = static_cast<ChunkNumber>(best - brightest_.begin());
        if (!frame_.may_read(transport_.row_bytes(chunk))) return false;
        const PatchNumber patch = best->patch;
        const Channels sent = std::exchange(unshot_[patch], {0, 0, 0});
        const PatchNumber row = patch - transport_.first(chunk);
        Lanes row_sum;
        if (const std::shared_ptr<const Block> block = transport_.load_diagonal(chunk)) {
            send_along_row(*block, row, chunk, sent, row_sum);
            send_along_column(*block, row, chunk, sent, row_sum);
        }
        find_brightest(chunk);
        for (const RowBlock& target : transport_.row(chunk)) {
            const std::shared_ptr<const Block> block = transport_.load(target.index);
            if (target.is_a)
                send_along_row(*block, row, target.other, sent, row_sum);
            else
                send_along_column(*block, row, target.other, sent, row_sum);
            find_brightest(target.other);
        }
        if (!adjoint_.hold_for(transport_, patch, std::span(&row_sum, 1)))
            adjoint_.certify_by_reads(transport_, frame_.emits());
        return true;
    }

    /// To the patches of block.b.
    void send_along_row(const Block& block, PatchNumber row, ChunkNumber to, const Channels& sent, Lanes& row_sum) {
        for (std::size_t k = block.row_begin[row]; k < block.row_begin[row + 1]; ++k)
            receive(transport_.first(to) + block.columns[k], block.areas_m2[k], sent, row_sum);
    }
    /// To the patches of block.a.
    void send_along_column(const Block& block, PatchNumber column, ChunkNumber to, const Channels& sent,
                           Lanes& row_sum) {
        for (std::size_t row = 0; row + 1 < block.row_begin.size(); ++row) {
            const auto begin = block.columns.begin() + block.row_begin[row],
                       end = block.columns.begin() + block.row_begin[row + 1];
            const auto found = std::lower_bound(begin, end, column);
            if (found == end || *found != column) continue;
            receive(transport_.first(to) + static_cast<PatchNumber>(row),
                    block.areas_m2[static_cast<std::size_t>(found - block.columns.begin())], sent, row_sum);
        }
    }
    void receive(PatchNumber patch, float exchange_m2, const Channels& sent, Lanes& row_sum) {
        const auto g = static_cast<double>(exchange_m2);
        row_sum.v[3] += g;
        for (std::size_t c = 0; c < 3; ++c) {
            const double received = g * sent[c] / transport_.area_m2(patch);
            irradiance_[patch][c] += received;
            unshot_[patch][c] += transport_.scaled_reflectance(patch)[c] * received;
        }
    }

    std::vector<Brightest> brightest_;  ///< per chunk
};

}  // namespace

SolveResult solve_by_shooting_patches(BlockSource& source, const SolveInput& input, const SolveOptions& options) {
    SolveFrame frame(source, input, options, "shoot-patch");
    if (frame.is_trivial()) return frame.trivial_result();
    return PatchShooter(frame).run();
}

}  // namespace luxel
