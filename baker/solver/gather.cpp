#include "baker/solver/gather.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "baker/core/parallel.h"
#include "baker/solver/adjoint.h"
#include "baker/solver/chunk_system.h"
#include "baker/solver/solve_frame.h"
#include "baker/solver/whole_read.h"

namespace luxel {
namespace {

/// What the inner solve of a chunk leaves: a share of what it begins with, or, where that is more, so little that all
/// chunks together leave this share of the tolerance.
constexpr double inner_share = 1e-3, inner_tolerance_share = 0.1;
constexpr std::uint32_t max_inner_iterations = 1000;

/// Sums of what is still wrong and of the light, for bound_of_error().
struct Sums {
    Channels weighted{0, 0, 0}, negative{0, 0, 0}, power{0, 0, 0};
    void add(std::size_t c, double weight, double wrong, double light) {
        weighted[c] += weight * std::abs(wrong);
        if (wrong < 0) negative[c] -= weight * wrong;
        power[c] += light;
    }
    [[nodiscard]] double bound() const { return bound_of_error(weighted, negative, power); }
};

class Jacobi {
  public:
    explicit Jacobi(SolveFrame& frame)
        : frame_(frame),
          transport_(frame.transport()),
          adjoint_(Adjoint::certify(transport_, frame.emits())),
          sent_(transport_.layout().patch_count()),
          irradiance_(sent_.size(), {0, 0, 0}),
          unshot_(irradiance_) {}

    SolveResult run() {
        while (!frame_.is_done(error_bound()) && frame_.may_read(frame_.total_bytes())) sweep();
        return frame_.finish(irradiance_, unshot_);
    }

  private:
    [[nodiscard]] double radiosity(PatchNumber i, std::size_t c) const {
        return frame_.emitted(i, c) + transport_.scaled_reflectance(i)[c] * irradiance_[i][c];
    }
    double error_bound() {
        Sums sums;
        for (PatchNumber i = 0; i < sent_.size(); ++i)
            for (std::size_t c = 0; c < 3; ++c) {
                unshot_[i][c] = radiosity(i, c) - sent_[i].v[c];
                sums.add(c, transport_.area_m2(i) * adjoint_.weight(i)[c], unshot_[i][c],
                         transport_.area_m2(i) * radiosity(i, c));
            }
        return sums.bound();
    }
    void sweep() {
        for (PatchNumber i = 0; i < sent_.size(); ++i)
            for (std::size_t c = 0; c < 3; ++c) sent_[i].v[c] = radiosity(i, c);
        const std::vector<Lanes> exchange = exchange_everywhere(transport_, sent_);
        for (PatchNumber i = 0; i < sent_.size(); ++i)
            for (std::size_t c = 0; c < 3; ++c) irradiance_[i][c] = exchange[i].v[c] / transport_.area_m2(i);
    }

    SolveFrame& frame_;
    Transport& transport_;
    Adjoint adjoint_;
    std::vector<Lanes> sent_;
    std::vector<Channels> irradiance_, unshot_;
};

class Gatherer {
  public:
    explicit Gatherer(SolveFrame& frame)
        : frame_(frame),
          transport_(frame.transport()),
          adjoint_(Adjoint::certify(transport_, frame.emits())),
          radiosity_(transport_.layout().patch_count()),
          below_(radiosity_.size()),
          irradiance_(radiosity_.size(), {0, 0, 0}),
          change_(irradiance_) {
        for (PatchNumber i = 0; i < radiosity_.size(); ++i)
            for (std::size_t c = 0; c < 3; ++c) {
                radiosity_[i].v[c] = frame.emitted(i, c);
                power_[c] += transport_.area_m2(i) * radiosity_[i].v[c];
            }
        // Before the first sweep nobody has received anything.
        for (PatchNumber i = 0; i < radiosity_.size(); ++i)
            for (std::size_t c = 0; c < 3; ++c) change_[i][c] = radiosity_[i].v[c];
    }

    SolveResult run() {
        while (!frame_.is_done(error_bound()) && frame_.may_read(2 * frame_.total_bytes()))
            for (ChunkNumber chunk = 0; chunk < transport_.layout().chunk_count(); ++chunk) strip(chunk);
        return frame_.finish(irradiance_, change_);
    }

  private:
    double error_bound() {
        Sums sums;
        for (PatchNumber i = 0; i < radiosity_.size(); ++i)
            for (std::size_t c = 0; c < 3; ++c) {
                const double weight = transport_.area_m2(i) * adjoint_.weight(i)[c];
                const double rest = started_ ? frame_.emitted(i, c) +
                                                   transport_.scaled_reflectance(i)[c] * irradiance_[i][c] -
                                                   radiosity_[i].v[c]
                                             : 0.0;
                sums.add(c, weight, change_[i][c], transport_.area_m2(i) * radiosity_[i].v[c]);
                // The rest may be of either sign beside the change.
                sums.weighted[c] += weight * std::abs(rest);
                sums.negative[c] += weight * std::abs(rest);
            }
        power_ = sums.power;
        return sums.bound();
    }

    void strip(ChunkNumber chunk) {
        started_ = true;
        const PatchNumber first = transport_.first(chunk);
        const std::size_t count = transport_.size(chunk);
        std::vector<RowBlock> behind;
        for (const RowBlock& block : transport_.row(chunk))
            if (block.is_a) behind.push_back(block);
        const std::vector<Lanes> gathered = gather_along(chunk, behind);
        Block diagonal;
        const bool has_pairs = transport_.load_diagonal(chunk, diagonal);
        const ChunkSystem system(transport_, chunk, has_pairs ? &diagonal : nullptr);
        const std::vector<Lanes> solved = solve_inside(system, gathered);
        std::vector<Lanes> inside;
        system.multiply(solved, inside);
        for (std::size_t i = 0; i < count; ++i)
            for (std::size_t c = 0; c < 3; ++c) {
                const PatchNumber patch = first + static_cast<PatchNumber>(i);
                irradiance_[patch][c] = (gathered[i].v[c] + inside[i].v[c]) / transport_.area_m2(patch);
                change_[patch][c] = solved[i].v[c] - radiosity_[patch].v[c];
            }
        std::copy(solved.begin(), solved.end(), radiosity_.begin() + first);
        parallel_for(behind.size(), 1, [&](std::size_t k) {
            Block block;
            transport_.load(behind[k].index, block);
            scatter_columns(block, solved, of_chunk(below_, behind[k].other));
        });
    }

    std::span<Lanes> of_chunk(std::vector<Lanes>& all, ChunkNumber chunk) const {
        return std::span(all).subspan(transport_.first(chunk), transport_.size(chunk));
    }

    /// What the chunk receives from the others: from those before it by their scatter, from those behind it along the
    /// strip.
    std::vector<Lanes> gather_along(ChunkNumber chunk, std::span<const RowBlock> behind) {
        const std::span<Lanes> from_before = of_chunk(below_, chunk);
        std::vector<Lanes> gathered(from_before.begin(), from_before.end());
        std::fill(from_before.begin(), from_before.end(), Lanes{});
        std::vector<std::vector<Lanes>> parts(transport_batch_blocks);
        for (std::size_t first = 0; first < behind.size(); first += transport_batch_blocks) {
            const std::size_t batch = std::min(transport_batch_blocks, behind.size() - first);
            parallel_for(batch, 1, [&](std::size_t k) {
                Block block;
                transport_.load(behind[first + k].index, block);
                parts[k].assign(gathered.size(), Lanes{});
                gather_rows(block, of_chunk(radiosity_, behind[first + k].other), parts[k]);
            });
            for (std::size_t k = 0; k < batch; ++k)
                for (std::size_t i = 0; i < gathered.size(); ++i)
                    for (std::size_t c = 0; c < 3; ++c) gathered[i].v[c] += parts[k][i].v[c];
        }
        return gathered;
    }

    /// X = M' + rho' gathered / A + K_aa X, up to a rest that the bound hardly notices.
    std::vector<Lanes> solve_inside(const ChunkSystem& system, std::span<const Lanes> gathered) const {
        const PatchNumber first = transport_.first(system.chunk());
        std::vector<Lanes> solved(gathered.size()), right, y(gathered.size()), weight(gathered.size());
        for (std::size_t i = 0; i < gathered.size(); ++i)
            for (std::size_t c = 0; c < 3; ++c) {
                const PatchNumber patch = first + static_cast<PatchNumber>(i);
                solved[i].v[c] = frame_.emitted(patch, c) +
                                 transport_.scaled_reflectance(patch)[c] * gathered[i].v[c] / transport_.area_m2(patch);
                const double s = system.scale()[i].v[c];
                weight[i].v[c] = s * transport_.area_m2(patch) * adjoint_.weight(patch)[c];
                // From the radiosity of the sweep before: where little has arrived since, nothing changes at all.
                y[i].v[c] = s > 0 ? (radiosity_[patch].v[c] - solved[i].v[c]) / s : 0.0;
            }
        if (!system.has_pairs()) return solved;
        // As in shooting: X = f + s y with (I - s G s) y = s G f.
        system.multiply(solved, right);
        for (std::size_t i = 0; i < right.size(); ++i)
            for (std::size_t c = 0; c < 3; ++c) right[i].v[c] *= system.scale()[i].v[c];
        std::optional<Lanes> limit;
        const auto stop = [&](std::span<const Lanes> residual) {
            Lanes rest;
            for (std::size_t i = 0; i < residual.size(); ++i)
                for (std::size_t c = 0; c < 3; ++c) rest.v[c] += weight[i].v[c] * std::abs(residual[i].v[c]);
            if (!limit) {
                limit.emplace();
                for (std::size_t c = 0; c < 3; ++c)
                    limit->v[c] = std::max(inner_share * rest.v[c],
                                           inner_tolerance_share * frame_.options().tolerance * power_[c] /
                                               static_cast<double>(transport_.layout().chunk_count()));
            }
            return rest.v[0] <= limit->v[0] && rest.v[1] <= limit->v[1] && rest.v[2] <= limit->v[2];
        };
        system.solve(right, y, stop, max_inner_iterations);
        for (std::size_t i = 0; i < solved.size(); ++i)
            for (std::size_t c = 0; c < 3; ++c) solved[i].v[c] += system.scale()[i].v[c] * y[i].v[c];
        return solved;
    }

    SolveFrame& frame_;
    Transport& transport_;
    Adjoint adjoint_;
    std::vector<Lanes> radiosity_, below_;  ///< x; sum of G_ij x_j over the chunks before, of this sweep
    std::vector<Channels> irradiance_, change_;
    Channels power_{0, 0, 0};
    bool started_ = false;
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
