/// Adjoint weights scaled chunk by chunk: the smallest model of how chunks exchange light, with one unknown per chunk,
/// gathered for free while the certificate reads (certificate.h). Light itself has a richer one: coarse_space.h.
///
/// With weights w as basis (one function per chunk, zero elsewhere) the Galerkin form of (I - T) w = 1, made symmetric
/// by rho' A, is   (E_a - C_aa) s_a - sum_b C_ab s_b = R_a   with
///     E_a = sum_a rho' A w^2,  R_a = sum_a rho' A w,  C_ab = sum_{i in a, j in b} (rho' w)_i G_ij (rho' w)_j,
/// and s_a scales the weights of chunk a. Units: m2. Memory: 24 bytes per
/// block and chunk. Threads: the setters are called at the same time for different blocks and chunks.
#pragma once
#include <span>
#include <vector>

#include "baker/formfactors/block_apply.h"
#include "baker/solver/transport.h"

namespace luxel {

class CoarseWeights {
  public:
    explicit CoarseWeights(const Transport& transport);
    /// Of block (a, b), a != b: x_a = rho' w of a, y_a = sum over b of G rho' w.
    void set_coupling(std::size_t block_index, std::span<const Lanes> x_a, std::span<const Lanes> y_a);
    /// inside = T_aa w.
    void set_chunk(ChunkNumber chunk, std::span<const Lanes> w, std::span<const Lanes> inside);
    /// Multiplies the weights of each chunk by its solution; leaves a channel as it is where there is none that is
    /// positive and finite (light that never ends).
    void scale(std::vector<Channels>& weights) const;

  private:
    /// s per chunk, for a right-hand side per chunk; empty if the matrix is not positive (light that never ends).
    [[nodiscard]] std::vector<double> solve(std::size_t channel, const std::vector<double>& right) const;
    void apply(std::size_t channel, const std::vector<double>& x, std::vector<double>& y) const;

    const Transport& transport_;
    std::vector<Channels> coupling_;  ///< per block; unused on the diagonal
    std::vector<Channels> diagonal_;  ///< E - C_aa per chunk
    std::vector<Channels> right_;     ///< R per chunk
};

}  // namespace luxel
