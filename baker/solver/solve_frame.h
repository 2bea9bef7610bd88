/// What every solver begins and ends with: checks, scale, the course of the solve, and the result in the caller's
/// units.
///
/// Each channel is divided by a power of two near its largest emission and multiplied back, which changes no bit of the
/// mantissas. Ownership: keeps references to source, input and options. Threads: one at a time.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "baker/solver/history.h"
#include "baker/solver/solver.h"
#include "baker/solver/transport.h"

namespace luxel {

class SolveFrame {
  public:
    /// Throws Error{bad_input} for emission that is negative or not finite, and where a patch sends its light to itself
    /// for ever; Error{internal} for sizes that do not fit.
    SolveFrame(BlockSource& source, const SolveInput& input, const SolveOptions& options, std::string solver);

    /// No light, or nothing reflects: the result is known without a read.
    [[nodiscard]] bool is_trivial() const { return trivial_; }
    [[nodiscard]] SolveResult trivial_result() const;

    [[nodiscard]] Transport& transport() { return transport_; }
    [[nodiscard]] const SolveOptions& options() const { return options_; }
    /// Per patch, whether it emits in any channel.
    [[nodiscard]] std::span<const std::uint8_t> emits() const { return emits_; }
    /// M' in the solver's scale.
    [[nodiscard]] double emitted(PatchNumber patch, std::size_t channel) const;
    /// Bytes of one read of all blocks.
    [[nodiscard]] std::uint64_t total_bytes() const { return total_bytes_; }

    /// Notes where the solve is. True: the bound is met.
    bool is_done(double error_bound);
    /// May so many bytes more be read?
    [[nodiscard]] bool may_read(std::uint64_t bytes) const;

    /// The result, from what every patch has received from the others (irradiance, without its own part) and the unshot
    /// rest; both in the solver's scale, one entry per patch.
    [[nodiscard]] SolveResult finish(std::span<const Channels> irradiance, std::span<const Channels> unshot);

  private:
    BlockSource& source_;
    const SolveInput& input_;
    const SolveOptions& options_;
    std::array<bool, 3> is_lit_{};
    const Channels scale_;
    Transport transport_;
    std::vector<std::uint8_t> emits_;
    const std::uint64_t total_bytes_, disk_bytes_before_;
    bool trivial_ = false;
    History history_;
    SolveResult result_;
};

/// An upper bound of sum A |B* - B| over sum A B*, the worst channel, from three sums per channel: of A w |U|
/// (adjoint.h), of its part with U < 0, and of A B. Infinite while there is no lower bound of the light.
double bound_of_error(const Channels& weighted_unshot, const Channels& negative_part, const Channels& power);

}  // namespace luxel
