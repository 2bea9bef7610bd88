#include "baker/solver/conjugate.h"

#include <algorithm>
#include <cmath>

#include "baker/core/parallel.h"
#include "baker/solver/certified_solver.h"
#include "baker/solver/coarse_space.h"
#include "baker/solver/whole_read.h"

namespace luxel {
namespace {

/// The last read may show that rounding has let the residual drift: the steps aim a little lower than asked.
constexpr double aim = 0.9;

class Conjugate final : public CertifiedSolver {
  public:
    explicit Conjugate(SolveFrame& frame)
        : CertifiedSolver(frame,
                          {7, 4 * frame.patch_count(), 4 * frame.patch_count(), 4 * frame.patch_count(), any_size}),
          count_(frame.patch_count()),
          scale_(count_),
          x_(count_),
          r_(count_),
          p_(count_),
          coarse_(transport_) {
        for (PatchNumber i = 0; i < count_; ++i)
            for (std::size_t c = 0; c < 3; ++c)
                scale_[i].v[c] = std::sqrt(transport_.scaled_reflectance(i)[c] / transport_.area_m2(i));
        if (const auto own = take_own_numbers()) {
            go_on(*own);
            return;
        }
        for (PatchNumber i = 0; i < count_; ++i) {
            for (std::size_t c = 0; c < 3; ++c) x_[i].v[c] = unshot_[i][c] = frame.emitted(i, c);
            x_[i].v[3] = 1;
        }
    }

    SolveResult run() {
        bool done = !stepping_ && frame_.is_done(bound(), *this);
        while (!done) {
            if (!stepping_ && !is_gathered_) {
                if (!frame_.may_read(frame_.total_bytes())) break;
                gather();
                if (frame_.is_done(bound(), *this)) break;
            }
            if (!stepping_) begin_steps();
            done = improve();
            stepping_ = is_gathered_ = false;
        }
        return frame_.finish(*this);
    }

  private:
    [[nodiscard]] std::vector<std::vector<double>> own_numbers() const override {
        return {{stepping_ ? 1.0 : 0.0, has_model_ ? 1.0 : 0.0, is_gathered_ ? 1.0 : 0.0, deflates_ ? 1.0 : 0.0,
                 rest_[0], rest_[1], rest_[2]},
                to_numbers(x_),
                to_numbers(r_),
                to_numbers(p_),
                coarse_.save()};
    }
    void go_on(const std::vector<std::vector<double>>& own) {
        stepping_ = own[0][0] > 0;
        has_model_ = own[0][1] > 0;
        is_gathered_ = own[0][2] > 0;
        deflates_ = own[0][3] > 0;
        std::copy_n(own[0].begin() + 4, 3, rest_.begin());
        from_numbers(own[1], x_);
        from_numbers(own[2], r_);
        from_numbers(own[3], p_);
        coarse_.restore(own[4]);
    }

    /// B from one read of x, and what x lacks: U = B - x.
    void gather() {
        const bool is_first = !has_model_;
        has_model_ = is_gathered_ = true;
        const std::vector<Lanes> exchange =
            is_first ? exchange_and_columns(transport_, x_, coarse_) : exchange_everywhere(transport_, x_);
        if (is_first) adjoint_.lower_by(coarse_, transport_);
        if (!adjoint_.hold_for(transport_, 0, exchange)) adjoint_.certify_by_reads(transport_, frame_.emits());
        for (PatchNumber i = 0; i < count_; ++i)
            for (std::size_t c = 0; c < 3; ++c) {
                irradiance_[i][c] = exchange[i].v[c] / transport_.area_m2(i);
                unshot_[i][c] =
                    frame_.emitted(i, c) + transport_.scaled_reflectance(i)[c] * irradiance_[i][c] - x_[i].v[c];
            }
    }

    /// Of x and U.
    [[nodiscard]] double bound() const {
        ErrorSums sums;
        for (PatchNumber i = 0; i < count_; ++i)
            for (std::size_t c = 0; c < 3; ++c)
                sums.add(c, transport_.area_m2(i), adjoint_.weight(i)[c], unshot_[i][c], x_[i].v[c] + unshot_[i][c]);
        return sums.bound(frame_.emitted_power());
    }

    /// The model takes its part of the residual U of x; the rest is the first direction.
    void begin_steps() {
        const std::vector<Channels> levels = coarse_.levels(unshot_);
        deflates_ = !levels.empty() && coarse_.vector_count() > 0;
        if (deflates_) {
            coarse_.send(levels, irradiance_, unshot_);
            for (PatchNumber i = 0; i < count_; ++i)
                for (std::size_t c = 0; c < 3; ++c)
                    x_[i].v[c] =
                        frame_.emitted(i, c) + transport_.scaled_reflectance(i)[c] * irradiance_[i][c] - unshot_[i][c];
        }
        for (PatchNumber i = 0; i < count_; ++i)
            for (std::size_t c = 0; c < 3; ++c) r_[i].v[c] = scale_[i].v[c] > 0 ? unshot_[i][c] / scale_[i].v[c] : 0.0;
        p_ = r_;
        deflate();
        rest_ = dot(r_, r_);
        stepping_ = true;
    }

    /// Takes out of the direction what the model holds, so that a step does not bring it back.
    void deflate() {
        if (!deflates_) return;
        const std::vector<Channels> levels = coarse_.deflation(unshot_);
        if (levels.empty()) return;
        parallel_for(transport_.layout().chunk_count(), 1, [&](std::size_t k) {
            const auto chunk = static_cast<ChunkNumber>(k);
            const CoarseSpace::Exchange model = coarse_.exchange(chunk, levels);
            for (std::size_t i = 0; i < model.sent.size(); ++i) {
                const PatchNumber patch = transport_.first(chunk) + static_cast<PatchNumber>(i);
                for (std::size_t c = 0; c < 3; ++c)
                    if (scale_[patch].v[c] > 0) p_[patch].v[c] -= model.sent[i][c] / scale_[patch].v[c];
            }
        });
    }

    /// Steps until the bound is low enough for the last read, or reads run out. True: the caller wants no more.
    bool improve() {
        std::vector<Lanes> q(count_);
        if (bound() <= aim * frame_.options().tolerance) return false;  // the model alone was enough
        while (frame_.may_read(2 * frame_.total_bytes())) {
            apply(p_, q);
            const Channels curvature = dot(p_, q);
            Channels step{0, 0, 0};
            for (std::size_t c = 0; c < 3; ++c) step[c] = curvature[c] > 0 ? rest_[c] / curvature[c] : 0.0;
            if (step == Channels{0, 0, 0}) return false;  // only rounding is left
            for (PatchNumber i = 0; i < count_; ++i)
                for (std::size_t c = 0; c < 3; ++c) {
                    x_[i].v[c] += scale_[i].v[c] * step[c] * p_[i].v[c];
                    r_[i].v[c] -= step[c] * q[i].v[c];
                    unshot_[i][c] = scale_[i].v[c] * r_[i].v[c];
                    const double reflects = transport_.scaled_reflectance(i)[c];
                    if (reflects > 0)
                        irradiance_[i][c] = (x_[i].v[c] + unshot_[i][c] - frame_.emitted(i, c)) / reflects;
                }
            const double found = bound();
            const Channels next = dot(r_, r_);
            if (found <= aim * frame_.options().tolerance || next == Channels{0, 0, 0}) return false;
            for (PatchNumber i = 0; i < count_; ++i)
                for (std::size_t c = 0; c < 3; ++c)
                    p_[i].v[c] = r_[i].v[c] + (rest_[c] > 0 ? next[c] / rest_[c] : 0.0) * p_[i].v[c];
            deflate();
            rest_ = next;
            if (frame_.note(found, *this)) return true;
        }
        return false;
    }

    /// q = (I - s G s) p.
    void apply(std::span<const Lanes> p, std::vector<Lanes>& q) {
        std::vector<Lanes> scaled(count_);
        for (PatchNumber i = 0; i < count_; ++i)
            for (std::size_t c = 0; c < 3; ++c) scaled[i].v[c] = scale_[i].v[c] * p[i].v[c];
        const std::vector<Lanes> exchange = exchange_everywhere(transport_, scaled);
        for (PatchNumber i = 0; i < count_; ++i)
            for (std::size_t c = 0; c < 3; ++c) q[i].v[c] = p[i].v[c] - scale_[i].v[c] * exchange[i].v[c];
    }

    static Channels dot(std::span<const Lanes> a, std::span<const Lanes> b) {
        Channels sum{0, 0, 0};
        for (std::size_t i = 0; i < a.size(); ++i)
            for (std::size_t c = 0; c < 3; ++c) sum[c] += a[i].v[c] * b[i].v[c];
        return sum;
    }

    const std::size_t count_;
    std::vector<Lanes> scale_, x_;  ///< s; the radiosity that is being improved, 1 in the spare lane
    // Of the steps: residual and direction in the symmetric form, the residual's square.
    bool stepping_ = false;
    std::vector<Lanes> r_, p_;
    Channels rest_{0, 0, 0};
    CoarseSpace coarse_;
    bool has_model_ = false;    ///< the model has had its read
    bool is_gathered_ = false;  ///< irradiance and unshot light are those of x, found by a read
    bool deflates_ = false;
};

}  // namespace

SolveResult solve_by_conjugate_gradients(BlockSource& source, const SolveInput& input, const SolveOptions& options) {
    SolveFrame frame(source, input, options, "cg");
    if (frame.is_trivial()) return frame.trivial_result();
    return Conjugate(frame).run();
}

}  // namespace luxel
