#include "baker/solver/conjugate.h"

#include <algorithm>
#include <cmath>

#include "baker/solver/adjoint.h"
#include "baker/solver/solve_frame.h"
#include "baker/solver/whole_read.h"

namespace luxel {
namespace {

/// The last read may show that rounding has let the residual drift: the steps aim a little lower than asked.
constexpr double aim = 0.9;

class Conjugate {
  public:
    explicit Conjugate(SolveFrame& frame)
        : frame_(frame),
          transport_(frame.transport()),
          adjoint_(Adjoint::certify(transport_, frame.emits())),
          count_(transport_.layout().patch_count()),
          scale_(count_),
          x_(count_),
          irradiance_(count_, {0, 0, 0}),
          unshot_(irradiance_) {
        for (PatchNumber i = 0; i < count_; ++i) {
            for (std::size_t c = 0; c < 3; ++c) {
                scale_[i].v[c] = std::sqrt(transport_.scaled_reflectance(i)[c] / transport_.area_m2(i));
                x_[i].v[c] = unshot_[i][c] = frame.emitted(i, c);
            }
            x_[i].v[3] = 1;
        }
    }

    SolveResult run() {
        bool done = frame_.is_done(bound());
        while (!done && frame_.may_read(frame_.total_bytes())) {
            gather();
            done = frame_.is_done(bound());
            if (!done) improve();
        }
        return frame_.finish(irradiance_, unshot_);
    }

  private:
    /// B from one read of x, and what x lacks: U = B - x.
    void gather() {
        const std::vector<Lanes> exchange = exchange_everywhere(transport_, x_);
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
                sums.add(c, transport_.area_m2(i) * adjoint_.weight(i)[c], unshot_[i][c],
                         transport_.area_m2(i) * (x_[i].v[c] + unshot_[i][c]));
        return sums.bound();
    }

    /// Steps from the residual U of x until the bound is low enough for the last read, or reads run out.
    void improve() {
        std::vector<Lanes> r(count_), p, q(count_);
        for (PatchNumber i = 0; i < count_; ++i)
            for (std::size_t c = 0; c < 3; ++c) r[i].v[c] = scale_[i].v[c] > 0 ? unshot_[i][c] / scale_[i].v[c] : 0.0;
        p = r;
        Channels rest = dot(r, r);
        while (frame_.may_read(2 * frame_.total_bytes())) {
            apply(p, q);
            const Channels curvature = dot(p, q);
            Channels step{0, 0, 0};
            for (std::size_t c = 0; c < 3; ++c) step[c] = curvature[c] > 0 ? rest[c] / curvature[c] : 0.0;
            for (PatchNumber i = 0; i < count_; ++i)
                for (std::size_t c = 0; c < 3; ++c) {
                    x_[i].v[c] += scale_[i].v[c] * step[c] * p[i].v[c];
                    r[i].v[c] -= step[c] * q[i].v[c];
                    unshot_[i][c] = scale_[i].v[c] * r[i].v[c];
                }
            const double found = bound();
            if (found <= aim * frame_.options().tolerance) return;
            frame_.note(found);
            const Channels next = dot(r, r);
            if (next == Channels{0, 0, 0}) return;
            for (PatchNumber i = 0; i < count_; ++i)
                for (std::size_t c = 0; c < 3; ++c)
                    p[i].v[c] = r[i].v[c] + (rest[c] > 0 ? next[c] / rest[c] : 0.0) * p[i].v[c];
            rest = next;
        }
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

    SolveFrame& frame_;
    Transport& transport_;
    Adjoint adjoint_;
    const std::size_t count_;
    std::vector<Lanes> scale_, x_;  ///< s; the radiosity that is being improved, 1 in the spare lane
    std::vector<Channels> irradiance_, unshot_;
};

}  // namespace

SolveResult solve_by_conjugate_gradients(BlockSource& source, const SolveInput& input, const SolveOptions& options) {
    SolveFrame frame(source, input, options, "cg");
    if (frame.is_trivial()) return frame.trivial_result();
    return Conjugate(frame).run();
}

}  // namespace luxel
