/// Certified adjoint weights: how much light a unit of unshot radiosity can still become, at most.
///
/// Transport K_ij = rho'_i G_ij / A_i (transport.h). The light still to come from unshot radiosity U has the total
/// power
///     sum A (I - K)^-1 U = sum_i A_i w*_i U_i,   w* = 1 + T w*,   T_ij = G_ij rho'_j / A_i >= 0   (A_i K_ij = A_j
///     T_ji).
///
/// 1. If some w > 0 satisfies w >= 1 + T w, then w >= w* (and the series converges): T w <= w - 1 < w bounds T's
/// spectral
///    radius below 1, and w - w* >= T (w - w*) repeated gives w - w* >= lim T^n (w - w*) = 0. Such a w is a
///    certificate.
/// 2. Replacing w_i by 1 + (T w)_i <= w_i, or a group of rows by anything that satisfies their own inequalities and is
///    not larger than before, keeps a certificate: the right-hand sides of all other rows only fall, since T >= 0.
/// 3. The smaller of two certificates, patch by patch, is one: the row of the smaller entry has a right-hand side at
/// most
///    that of the certificate it came from.
/// 4. For any w > 0 with w - T w >= m > 0 in every row, w / m is a certificate.
///
/// Weights have no unit. Memory: 24 bytes per patch. Threads: one at a time.
#pragma once
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "baker/solver/chunk_system.h"
#include "baker/solver/coarse_space.h"
#include "baker/solver/transport.h"

namespace luxel {

/// Rows longer than their area by this share are still taken as closed: sums of floats cannot be trusted further.
constexpr double row_excess_allowed = 1e-6;

class Adjoint {
  public:
    /// Starts without a read, from reflectances alone, in each channel where this gives at most `loosest`; rows that
    /// are longer than their area times 1 + row_excess_allowed would void it, so lower() looks for them. Otherwise
    /// reads the blocks until property 4 holds. `emits`: per patch, whether it emits in any channel. Throws
    /// Error{bad_input} if there is no certificate: the light never ends.
    static Adjoint certify(Transport& transport, std::span<const std::uint8_t> emits, double loosest = 1e6);

    /// Certifies by reads whatever the reflectances: needs no assumption about row sums.
    void certify_by_reads(Transport& transport, std::span<const std::uint8_t> emits);

    /// Everything as numbers, one more than three per patch, and back from them. Patches that the certificate made
    /// transport forget are forgotten again.
    [[nodiscard]] std::vector<double> save(const Transport& transport) const;
    static Adjoint restore(Transport& transport, std::span<const double> numbers);
    [[nodiscard]] const Channels& weight(PatchNumber patch) const { return weights_[patch]; }

    /// Do the weights hold for these rows? `exchange`: of the patches from `first` on, the sum over all j != i of G_ij
    /// in the spare lane. False if one is longer than allowed and the weights rely on rows not being so: then
    /// certify_by_reads() must follow before the weights are used.
    [[nodiscard]] bool hold_for(const Transport& transport, PatchNumber first, std::span<const Lanes> exchange) const;

    /// Lowers the weights of one chunk (property 2). `gathered`: sum over the patches j of all other chunks of
    /// G_ij rho'_j w_j per patch of the chunk, with sum G_ij in the spare lane. False as in hold_for().
    [[nodiscard]] bool lower(const Transport& transport, const ChunkSystem& system, std::span<const Lanes> gathered);

    /// Lowers the weights of all patches by the model's solution of w = 1 + T w (properties 2 to 4), without a read;
    /// false if that is no certificate, as where the model lacks chunks.
    bool lower_by(const CoarseSpace& model, const Transport& transport);

  private:
    std::vector<Channels> weights_;
    bool assumes_row_sums_ = false;
};

/// rho' w of a chunk, the vector that T multiplies; the spare lane is 1.
std::vector<Lanes> adjoint_source(const Transport& transport, const std::vector<Channels>& weights, ChunkNumber chunk);

/// How far from solved a row f - (w - T_aa w) may be: relative * f + absolute.
struct RowAccuracy {
    double relative = 0, absolute = 0;
};

/// Solves the rows of one chunk: w = f + T_aa w for f = 1 + gathered / A.
/// w is changed from a first guess to an approximate solution; no property is promised.
void solve_adjoint_rows(const Transport& transport, const ChunkSystem& system, std::span<const Lanes> gathered,
                        RowAccuracy accuracy, std::vector<Lanes>& w);

/// (T_aa w)_i per patch of the chunk; spare lane: sum over j != i in the chunk of G_ij / A_i.
std::vector<Lanes> apply_adjoint_inside(const Transport& transport, const ChunkSystem& system,
                                        std::span<const Lanes> w);

}  // namespace luxel
