/// What every solver begins and ends with: checks, scale, the course of the solve, and the result in the caller's
/// units.
///
/// Each channel is divided by a power of two near its largest emission and multiplied back, which changes no bit of the
/// mantissas. Ownership: keeps references to source, input and options. Threads: one at a time.
#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "baker/solver/history.h"
#include "baker/solver/solver.h"
#include "baker/solver/transport.h"

namespace luxel {

/// What a solver shows of itself between two steps.
class SolverVectors {
  public:
    virtual ~SolverVectors() = default;
    /// What every patch has received from the others (irradiance, without its own part), and its unshot rest: both in
    /// the solver's scale, one entry per patch.
    [[nodiscard]] virtual std::span<const Channels> irradiance() const = 0;
    [[nodiscard]] virtual std::span<const Channels> unshot() const = 0;
    /// SolveState::numbers.
    [[nodiscard]] virtual std::vector<std::vector<double>> save() const = 0;
};

/// A vector of SolveState::numbers whose size the solver checks itself.
constexpr std::size_t any_size = static_cast<std::size_t>(-1);

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
    /// Sum A M', lm in the solver's scale.
    [[nodiscard]] const Channels& emitted_power() const { return emitted_power_; }
    /// Bytes of one read of all blocks.
    [[nodiscard]] std::uint64_t total_bytes() const { return total_bytes_; }

    [[nodiscard]] std::size_t patch_count() const { return emits_.size(); }

    /// The numbers to go on from, which the frame no longer holds then; nothing at the beginning. `sizes`: of the
    /// vectors that the solver expects. Throws Error{internal} for others.
    [[nodiscard]] std::optional<std::vector<std::vector<double>>> resumed(std::span<const std::size_t> sizes) const;

    /// Notes where the solve is, for history, and lets the caller look. True: the caller wants no more.
    bool note(double error_bound, const SolverVectors& solver);
    /// note() of a state that may be the result. True: the bound is met, or the caller wants no more.
    bool is_done(double error_bound, const SolverVectors& solver);
    /// May so many bytes more be read?
    [[nodiscard]] bool may_read(std::uint64_t bytes) const;

    [[nodiscard]] SolveResult finish(const SolverVectors& solver);

  private:
    class View;
    [[nodiscard]] std::uint64_t bytes_read() const;
    /// H of all patches in the caller's units; `ambient` is added to it.
    [[nodiscard]] std::vector<Channels> scaled_irradiance(std::span<const Channels> irradiance,
                                                          const Channels& ambient) const;
    [[nodiscard]] Channels ambient(std::span<const Channels> unshot) const;

    BlockSource& source_;
    const SolveInput& input_;
    const SolveOptions& options_;
    std::array<bool, 3> is_lit_{};
    const Channels scale_;
    Transport transport_;
    std::vector<std::uint8_t> emits_;
    Channels emitted_power_{0, 0, 0};
    const std::uint64_t total_bytes_, disk_bytes_before_, resumed_bytes_;
    bool trivial_ = false, stopped_ = false;
    History history_;
    SolveResult result_;
};

/// An upper bound of sum A |B* - B| over sum A B*, the worst channel. Without a unit.
struct ErrorSums {
    Channels weighted{0, 0, 0};  ///< sum A w |U|, lm in the solver's scale (adjoint.h)
    Channels unshot{0, 0, 0};    ///< sum A |U|
    Channels negative{0, 0, 0};  ///< the part of it where U < 0
    Channels power{0, 0, 0};     ///< sum A B

    /// One patch in one channel: area A in m2, weight w, radiosities U and B.
    void add(std::size_t channel, double area_m2, double weight, double unshot_radiosity, double radiosity);
    void add(const ErrorSums& other);
    /// `emitted`: sum A M', which no light is less than.
    [[nodiscard]] double bound(const Channels& emitted) const;
};

}  // namespace luxel
