/// The exchange inside one chunk, solved in memory: conjugate gradients on the symmetric form.
///
/// With s_i = sqrt(rho'_i / A_i) both the light equation inside a chunk, (I - K_aa) X = U, and its adjoint become
///     (I - s G s) y = right-hand side,
/// symmetric, and positive definite as long as light inside the chunk ends. Patches that reflect nothing have s = 0 and
/// drop out. Three channels run side by side; a channel that is done, or whose matrix turns out not to be positive
/// (light that never ends, up to rounding), stops moving, and the caller finds out by its own check of the result.
/// Memory: 2 arrays of 32 bytes per patch of the chunk, up to 8 more for large blocks. Threads: uses them inside
/// multiply(); the result does not depend on their number. Source: Hestenes and Stiefel 1952; the symmetric positive
/// form of the radiosity equation: Neumann and Tobler, Eurographics Workshop on Rendering 1994.
#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "baker/solver/transport.h"

namespace luxel {

class ChunkSystem {
  public:
    /// Keeps a reference to `diagonal`, the block (chunk, chunk); nullptr where the chunk has no pairs of its own.
    ChunkSystem(const Transport& transport, ChunkNumber chunk, const Block* diagonal);

    [[nodiscard]] ChunkNumber chunk() const { return chunk_; }
    [[nodiscard]] std::size_t size() const { return scale_.size(); }
    [[nodiscard]] bool has_pairs() const { return diagonal_ != nullptr; }
    [[nodiscard]] std::span<const Lanes> scale() const { return scale_; }  ///< s; spare lane 0

    /// y = G x inside the chunk, without the diagonal.
    void multiply(std::span<const Lanes> x, std::vector<Lanes>& y) const;

    /// True when the residual, right-hand side minus (I - s G s) y, is small enough.
    using Stop = std::function<bool(std::span<const Lanes> residual)>;
    /// Improves `y` from the value given. Returns the number of iterations. The spare lane must be 0 in y and rhs.
    std::uint32_t solve(std::span<const Lanes> right_hand_side, std::vector<Lanes>& y, const Stop& stop,
                        std::uint32_t max_iterations) const;

  private:
    void apply(std::span<const Lanes> x, std::vector<Lanes>& scaled, std::vector<Lanes>& out) const;

    ChunkNumber chunk_;
    const Block* diagonal_;
    std::vector<Lanes> scale_;
    std::vector<std::size_t> part_rows_;  ///< boundaries of parts of about equal pair count
    mutable std::vector<std::vector<Lanes>> part_sums_;
};

}  // namespace luxel
