#include "baker/solver/adjoint.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "baker/solver/certificate.h"

namespace luxel {

namespace {

/// A margin w - T w below this share of w may be rounding and certifies nothing.
constexpr double smallest_margin = 1e-9;
/// Weights are raised by this share so that rounding in the check cannot turn a certificate into a near miss.
constexpr double rounding_reserve = 1e-10;
constexpr std::uint32_t max_inner_iterations = 200;

/// The certificate that needs no read. With g_i = -G_ii / A_i the rest of row i sums to at most 1 + g_i + e for
/// e = row_excess_allowed, D_i = 1 + rho_i g_i, and w_i = t D_i gives (T w)_i = t sum_j G_ij/A_i rho_j <= t rho_max (1
/// + g_i + e). So t = 1 / min_i(D_i - rho_max (1 + g_i + e)) does, where that minimum is positive. In a closed scene
/// without self-exchange it is 1 / (1 - rho_max). Returns the minimum.
double reflectance_margin(const Transport& transport, std::size_t channel) {
    double largest = 0;
    const std::uint32_t count = transport.layout().patch_count();
    for (PatchNumber i = 0; i < count; ++i)
        if (transport.scaled_reflectance(i)[channel] > 0)
            largest = std::max(largest, transport.reflectance(i, channel));
    if (largest == 0) return 1;  // nothing is sent on: w = 1
    double margin = 1;
    for (PatchNumber i = 0; i < count; ++i) {
        const double rest = 1 - transport.diagonal_m2(i) / transport.area_m2(i) + row_excess_allowed;
        margin = std::min(margin, transport.self_factor(i, channel) - largest * std::max(rest, 0.0));
    }
    return margin;
}

}  // namespace

std::vector<Lanes> adjoint_source(const Transport& transport, const std::vector<Channels>& weights, ChunkNumber chunk) {
    std::vector<Lanes> source(transport.size(chunk));
    for (std::size_t i = 0; i < source.size(); ++i) {
        const PatchNumber patch = transport.first(chunk) + static_cast<PatchNumber>(i);
        for (std::size_t c = 0; c < 3; ++c) source[i].v[c] = transport.scaled_reflectance(patch)[c] * weights[patch][c];
        source[i].v[3] = 1;
    }
    return source;
}

std::vector<Lanes> apply_adjoint_inside(const Transport& transport, const ChunkSystem& system,
                                        std::span<const Lanes> w) {
    const PatchNumber first = transport.first(system.chunk());
    std::vector<Lanes> source(w.size()), product;
    for (std::size_t i = 0; i < w.size(); ++i) {
        for (std::size_t c = 0; c < 3; ++c)
            source[i].v[c] = transport.scaled_reflectance(first + static_cast<PatchNumber>(i))[c] * w[i].v[c];
        source[i].v[3] = 1;
    }
    system.multiply(source, product);
    for (std::size_t i = 0; i < w.size(); ++i)
        for (std::size_t c = 0; c < 4; ++c) product[i].v[c] /= transport.area_m2(first + static_cast<PatchNumber>(i));
    return product;
}

void solve_adjoint_rows(const Transport& transport, const ChunkSystem& system, std::span<const Lanes> gathered,
                        RowAccuracy accuracy, std::vector<Lanes>& w) {
    const PatchNumber first = transport.first(system.chunk());
    const std::size_t count = w.size();
    std::vector<Lanes> right(count), limit(count), v(count);
    for (std::size_t i = 0; i < count; ++i) {
        const double area_m2 = transport.area_m2(first + static_cast<PatchNumber>(i));
        for (std::size_t c = 0; c < 3; ++c) {
            // v = sqrt(rho' A) w makes the rows symmetric; rho' w = s v.
            const double to_v = system.scale()[i].v[c] * area_m2;
            right[i].v[c] = to_v * (1 + gathered[i].v[c] / area_m2);
            limit[i].v[c] = accuracy.relative * right[i].v[c] + accuracy.absolute * to_v;
            v[i].v[c] = to_v * w[i].v[c];
        }
    }
    const auto stop = [&](std::span<const Lanes> residual) {
        for (std::size_t i = 0; i < count; ++i)
            for (std::size_t c = 0; c < 3; ++c)
                if (std::abs(residual[i].v[c]) > limit[i].v[c]) return false;
        return true;
    };
    system.solve(right, v, stop, max_inner_iterations);
    // Back to w by one more application, which also serves the patches that reflect nothing.
    std::vector<Lanes> product;
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t c = 0; c < 3; ++c) v[i].v[c] *= system.scale()[i].v[c];
    system.multiply(v, product);
    for (std::size_t i = 0; i < count; ++i) {
        const double area_m2 = transport.area_m2(first + static_cast<PatchNumber>(i));
        for (std::size_t c = 0; c < 3; ++c)
            w[i].v[c] = std::max(1.0, 1 + (gathered[i].v[c] + product[i].v[c]) / area_m2);
    }
}

namespace {

/// `others_m2`: sum over j != i of G_ij.
bool row_fits(const Transport& transport, PatchNumber i, double others_m2) {
    return (others_m2 + transport.diagonal_m2(i)) / transport.area_m2(i) <= 1 + row_excess_allowed;
}

}  // namespace

Adjoint Adjoint::certify(Transport& transport, std::span<const std::uint8_t> emits, double loosest) {
    Adjoint adjoint;
    const ChunkLayout& layout = transport.layout();
    std::array<double, 3> margin{};
    bool is_tight = true, exists = true;
    for (std::size_t c = 0; c < 3; ++c) {
        margin[c] = reflectance_margin(transport, c);
        is_tight = is_tight && margin[c] * loosest >= 1;
        exists = exists && margin[c] > smallest_margin;
    }
    if (!is_tight) {
        auto found = certificate_by_reads(transport, emits, !exists);
        if (found) {
            adjoint.weights_ = std::move(*found);
            return adjoint;
        }
    }
    adjoint.assumes_row_sums_ = true;
    adjoint.weights_.assign(layout.patch_count(), {1, 1, 1});
    for (ChunkNumber chunk = 0; chunk < layout.chunk_count(); ++chunk) {
        // Without any block nothing is sent on: the weight is 1 exactly.
        if (transport.row_bytes(chunk) == 0) continue;
        for (PatchNumber i = transport.first(chunk); i < layout.first_patch[chunk + 1]; ++i)
            for (std::size_t c = 0; c < 3; ++c)
                adjoint.weights_[i][c] =
                    std::max(1.0, transport.self_factor(i, c) / margin[c] * (1 + rounding_reserve));
    }
    return adjoint;
}

void Adjoint::certify_by_reads(Transport& transport, std::span<const std::uint8_t> emits) {
    weights_ = std::move(*certificate_by_reads(transport, emits, true));
    assumes_row_sums_ = false;
}

std::vector<double> Adjoint::save(const Transport& transport) const {
    std::vector<double> numbers{assumes_row_sums_ ? 1.0 : 0.0};
    numbers.reserve(1 + 3 * weights_.size());
    for (const Channels& weight : weights_) numbers.insert(numbers.end(), weight.begin(), weight.end());
    // Weights are at least 1: 0 is free to say "forgotten".
    for (const PatchNumber patch : transport.forgotten())
        for (std::size_t c = 0; c < 3; ++c) numbers[1 + 3 * std::size_t{patch} + c] = 0;
    return numbers;
}

Adjoint Adjoint::restore(Transport& transport, std::span<const double> numbers) {
    Adjoint adjoint;
    adjoint.assumes_row_sums_ = numbers[0] > 0;
    adjoint.weights_.resize(transport.layout().patch_count());
    for (PatchNumber i = 0; i < adjoint.weights_.size(); ++i) {
        for (std::size_t c = 0; c < 3; ++c) adjoint.weights_[i][c] = std::max(numbers[1 + 3 * std::size_t{i} + c], 1.0);
        if (numbers[1 + 3 * std::size_t{i}] == 0) transport.forget(i);
    }
    return adjoint;
}

bool Adjoint::hold_for(const Transport& transport, PatchNumber first, std::span<const Lanes> exchange) const {
    if (!assumes_row_sums_) return true;
    for (std::size_t i = 0; i < exchange.size(); ++i)
        if (!row_fits(transport, first + static_cast<PatchNumber>(i), exchange[i].v[3])) return false;
    return true;
}

bool Adjoint::lower(const Transport& transport, const ChunkSystem& system, std::span<const Lanes> gathered) {
    const PatchNumber first = transport.first(system.chunk());
    const std::size_t count = system.size();
    std::vector<Lanes> w(count);
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t c = 0; c < 3; ++c) w[i].v[c] = weights_[first + i][c];
    solve_adjoint_rows(transport, system, gathered, {.relative = 0.02}, w);
    const std::vector<Lanes> inside = apply_adjoint_inside(transport, system, w);
    // The approximate solution, raised until it satisfies its rows: w r - T_aa w r >= f.
    Lanes raise;
    bool rows_fit = true;
    for (std::size_t i = 0; i < count; ++i) {
        const PatchNumber patch = first + static_cast<PatchNumber>(i);
        const double area_m2 = transport.area_m2(patch);
        for (std::size_t c = 0; c < 3; ++c) {
            const double rest = w[i].v[c] - inside[i].v[c];
            const double wanted = 1 + gathered[i].v[c] / area_m2;
            const bool good = rest > smallest_margin * w[i].v[c];
            raise.v[c] = std::max(raise.v[c], good ? wanted / rest : std::numeric_limits<double>::infinity());
        }
        rows_fit = rows_fit && row_fits(transport, patch, gathered[i].v[3] + inside[i].v[3] * area_m2);
    }
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t c = 0; c < 3; ++c) {
            const double candidate = w[i].v[c] * raise.v[c] * (1 + rounding_reserve);
            weights_[first + i][c] = std::min(weights_[first + i][c], candidate);
        }
    return rows_fit || !assumes_row_sums_;
}

bool Adjoint::lower_by(const CoarseSpace& model, const Transport& transport) {
    // z = rho' w of w = 1 + T w is the light of the emission rho': z = rho' + K z.
    std::vector<Channels> rest(weights_.size()), received(weights_.size(), {0, 0, 0});
    for (PatchNumber i = 0; i < rest.size(); ++i) rest[i] = transport.scaled_reflectance(i);
    const std::vector<Channels> levels = model.levels(rest);
    if (levels.empty()) return false;
    model.send(levels, received, rest);  // rest = rho' - (z - K z), and received = T w
    Channels margin{1, 1, 1};
    for (PatchNumber i = 0; i < weights_.size(); ++i)
        for (std::size_t c = 0; c < 3; ++c) {
            const double reflect = transport.scaled_reflectance(i)[c];
            if (!(reflect > 0)) continue;  // T multiplies its weight by 0: it is found below
            const double difference = 1 - rest[i][c] / reflect, w = difference + received[i][c];
            margin[c] = std::min(margin[c], w > 0 && difference > smallest_margin * w ? difference : 0.0);
        }
    bool lowered = false;
    for (std::size_t c = 0; c < 3; ++c) {
        if (!(margin[c] > 0)) continue;
        lowered = true;
        // 1 + T (w / m) is at most w / m, and a certificate too (property 2).
        for (PatchNumber i = 0; i < weights_.size(); ++i)
            weights_[i][c] =
                std::min(weights_[i][c], (1 + std::max(received[i][c], 0.0) / margin[c]) * (1 + rounding_reserve));
    }
    return lowered;
}

}  // namespace luxel
