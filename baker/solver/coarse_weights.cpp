#include "baker/solver/coarse_weights.h"

#include <cmath>

namespace luxel {

namespace {

double dot(const std::vector<double>& x, const std::vector<double>& y) {
    double sum = 0;
    for (std::size_t i = 0; i < x.size(); ++i) sum += x[i] * y[i];
    return sum;
}

}  // namespace

CoarseWeights::CoarseWeights(const Transport& transport)
    : transport_(transport),
      coupling_(transport.blocks().size()),
      diagonal_(transport.layout().chunk_count()),
      right_(transport.layout().chunk_count()) {}

void CoarseWeights::set_coupling(std::size_t block_index, std::span<const Lanes> x_a, std::span<const Lanes> y_a) {
    Channels sum{0, 0, 0};
    for (std::size_t i = 0; i < x_a.size(); ++i)
        for (std::size_t c = 0; c < 3; ++c) sum[c] += x_a[i].v[c] * y_a[i].v[c];
    coupling_[block_index] = sum;
}

void CoarseWeights::set_chunk(ChunkNumber chunk, std::span<const Lanes> w, std::span<const Lanes> inside) {
    Channels diagonal{0, 0, 0}, right{0, 0, 0};
    for (std::size_t i = 0; i < w.size(); ++i) {
        const PatchNumber patch = transport_.first(chunk) + static_cast<PatchNumber>(i);
        for (std::size_t c = 0; c < 3; ++c) {
            const double moment = transport_.scaled_reflectance(patch)[c] * transport_.area_m2(patch) * w[i].v[c];
            right[c] += moment;
            diagonal[c] += moment * (w[i].v[c] - inside[i].v[c]);
        }
    }
    diagonal_[chunk] = diagonal;
    right_[chunk] = right;
}

void CoarseWeights::apply(std::size_t channel, const std::vector<double>& x, std::vector<double>& y) const {
    for (std::size_t a = 0; a < x.size(); ++a) y[a] = diagonal_[a][channel] * x[a];
    for (std::size_t k = 0; k < coupling_.size(); ++k) {
        const BlockInfo& block = transport_.blocks()[k];
        if (block.a == block.b) continue;
        y[block.a] -= coupling_[k][channel] * x[block.b];
        y[block.b] -= coupling_[k][channel] * x[block.a];
    }
}

/// Conjugate gradients, scaled by the diagonal.
std::vector<double> CoarseWeights::solve(std::size_t channel, const std::vector<double>& right) const {
    const std::size_t count = diagonal_.size();
    std::vector<double> x(count, 0.0), r = right, z(count), p(count), q(count);
    const auto scaled = [&](const std::vector<double>& v, std::vector<double>& out) {
        for (std::size_t a = 0; a < count; ++a) out[a] = diagonal_[a][channel] > 0 ? v[a] / diagonal_[a][channel] : 0.0;
    };
    const double target = 1e-20 * dot(r, r);  // a relative residual of 1e-10: exact for its purpose
    scaled(r, z);
    p = z;
    double rz = dot(r, z);
    for (std::size_t step = 0; step < 10 * count + 10 && dot(r, r) > target; ++step) {
        apply(channel, p, q);
        const double curvature = dot(p, q);
        if (!(curvature > 0 && rz > 0)) return {};
        const double length = rz / curvature;
        for (std::size_t a = 0; a < count; ++a) {
            x[a] += length * p[a];
            r[a] -= length * q[a];
        }
        scaled(r, z);
        const double next = dot(r, z);
        for (std::size_t a = 0; a < count; ++a) p[a] = z[a] + next / rz * p[a];
        rz = next;
    }
    return x;
}

void CoarseWeights::scale(std::vector<Channels>& weights) const {
    // Further than this the matrix is singular up to rounding, and scaling would only lose precision.
    constexpr double largest_scale = 1e9;
    for (std::size_t c = 0; c < 3; ++c) {
        std::vector<double> right(right_.size());
        for (std::size_t a = 0; a < right.size(); ++a) right[a] = right_[a][c];
        const std::vector<double> factors = solve(c, right);
        bool usable = !factors.empty();
        for (std::size_t a = 0; a < factors.size(); ++a)
            usable = usable && (right_[a][c] == 0 || (factors[a] > 0 && factors[a] < largest_scale));
        if (!usable) continue;
        for (ChunkNumber chunk = 0; chunk < factors.size(); ++chunk) {
            if (right_[chunk][c] == 0) continue;
            const double factor = factors[chunk];
            for (std::size_t i = 0; i < transport_.size(chunk); ++i) weights[transport_.first(chunk) + i][c] *= factor;
        }
    }
}

}  // namespace luxel
