#include "baker/accuracy/pattern_solve.h"

namespace luxel {
namespace {

using Lane = std::array<double, pattern_count>;

/// Conjugate gradients for the patches that reflect; the others stay 0.
class Solve {
  public:
    Solve(BlockSource& source, const LightState& light, std::size_t channel) : source_(source) {
        const std::size_t count = light.ids.size();
        operator_m2_.assign(count, 0.0);
        inverse_.assign(count, 0.0);
        for (std::size_t i = 0; i < count; ++i) {
            const double rho = static_cast<double>(light.reflectance[i][static_cast<int>(channel)]);
            if (!(rho > 0)) continue;
            operator_m2_[i] = light.area_m2[i] / rho;
            const double diagonal = operator_m2_[i] - source.diagonal_m2()[i];
            inverse_[i] = diagonal > 0 ? 1 / diagonal : 0;  // light that never ends in one patch has no error to spread
        }
    }

    Patterns run(const Patterns& noise, double tolerance) {
        const std::size_t count = noise.size();
        Patterns x(count, Pattern{}), r = noise, p(count);
        for (std::size_t i = 0; i < count; ++i)
            for (std::size_t v = 0; v < pattern_count; ++v) {
                if (inverse_[i] == 0) r[i][v] = 0;
                p[i][v] = static_cast<float>(inverse_[i] * static_cast<double>(r[i][v]));
            }
        Lane rest = preconditioned_square(r);
        const Lane first = rest;
        for (int pass = 0; pass < 60; ++pass) {
            bool done = true;
            for (std::size_t v = 0; v < pattern_count; ++v) done = done && rest[v] <= first[v] * tolerance * tolerance;
            if (done) break;
            advance(x, r, p, rest);
        }
        return x;
    }

  private:
    /// One step of all patterns. `rest`: the preconditioned square of the residual r, before and after.
    void advance(Patterns& x, Patterns& r, Patterns& p, Lane& rest) {
        const PatchSums<pattern_count> q = apply(p);
        Lane curvature{}, step{}, keep{};
        for (std::size_t i = 0; i < q.size(); ++i)
            for (std::size_t v = 0; v < pattern_count; ++v) curvature[v] += static_cast<double>(p[i][v]) * q[i][v];
        for (std::size_t v = 0; v < pattern_count; ++v) step[v] = curvature[v] > 0 ? rest[v] / curvature[v] : 0;
        for (std::size_t i = 0; i < q.size(); ++i)
            for (std::size_t v = 0; v < pattern_count; ++v) {
                x[i][v] += static_cast<float>(step[v] * static_cast<double>(p[i][v]));
                r[i][v] -= static_cast<float>(step[v] * q[i][v]);
            }
        const Lane next = preconditioned_square(r);
        for (std::size_t v = 0; v < pattern_count; ++v) keep[v] = rest[v] > 0 ? next[v] / rest[v] : 0;
        for (std::size_t i = 0; i < q.size(); ++i)
            for (std::size_t v = 0; v < pattern_count; ++v)
                p[i][v] = static_cast<float>(inverse_[i] * static_cast<double>(r[i][v]) + keep[v] * static_cast<double>(p[i][v]));
        rest = next;
    }

    [[nodiscard]] Lane preconditioned_square(const Patterns& r) const {
        Lane sum{};
        for (std::size_t i = 0; i < r.size(); ++i)
            for (std::size_t v = 0; v < pattern_count; ++v) {
                const double value = r[i][v];
                sum[v] += value * value * inverse_[i];
            }
        return sum;
    }

    PatchSums<pattern_count> apply(const Patterns& p) {
        PatchSums<pattern_count> q = exchange(source_, p);
        for (std::size_t i = 0; i < q.size(); ++i)
            for (std::size_t v = 0; v < pattern_count; ++v)
                q[i][v] = inverse_[i] == 0 ? 0.0 : operator_m2_[i] * static_cast<double>(p[i][v]) - q[i][v];
        return q;
    }

    BlockSource& source_;
    std::vector<double> operator_m2_, inverse_;
};

}  // namespace

PatchSums<pattern_count> exchange(BlockSource& source, const Patterns& x) {
    PatchSums<pattern_count> y =
        sum_over_pairs<pattern_count>(source, [&](PatchNumber i, PatchNumber j, double area_m2, Lane& to_i, Lane& to_j) {
            for (std::size_t v = 0; v < pattern_count; ++v) to_i[v] += area_m2 * static_cast<double>(x[j][v]);
            for (std::size_t v = 0; v < pattern_count; ++v) to_j[v] += area_m2 * static_cast<double>(x[i][v]);
        });
    const std::span<const double> diagonal = source.diagonal_m2();
    for (std::size_t i = 0; i < y.size(); ++i)
        for (std::size_t v = 0; v < pattern_count; ++v) y[i][v] += diagonal[i] * static_cast<double>(x[i][v]);
    return y;
}

Patterns solve_patterns(BlockSource& source, const LightState& light, std::size_t channel, const Patterns& rhs, double tolerance) {
    check(light);
    return Solve(source, light, channel).run(rhs, tolerance);
}

}  // namespace luxel
