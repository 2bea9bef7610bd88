/// What all solvers have: the frame of a solve, certified weights, what patches have received and what they have not
/// sent yet; and how these go to a saved state and come back.
#pragma once
#include <cstring>
#include <initializer_list>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "baker/solver/adjoint.h"
#include "baker/solver/solve_frame.h"

namespace luxel {

/// Vectors over patches as plain numbers, three or four per patch, and back.
template <class PerPatch>
std::vector<double> to_numbers(const std::vector<PerPatch>& values) {
    std::vector<double> numbers(values.size() * (sizeof(PerPatch) / sizeof(double)));
    std::memcpy(numbers.data(), values.data(), numbers.size() * sizeof(double));
    return numbers;
}
template <class PerPatch>
void from_numbers(std::span<const double> numbers, std::vector<PerPatch>& values) {
    values.resize(numbers.size() / (sizeof(PerPatch) / sizeof(double)));
    std::memcpy(static_cast<void*>(values.data()), numbers.data(), numbers.size_bytes());
}

class CertifiedSolver : public SolverVectors {
  public:
    [[nodiscard]] std::span<const Channels> irradiance() const final { return irradiance_; }
    [[nodiscard]] std::span<const Channels> unshot() const final { return unshot_; }
    [[nodiscard]] std::vector<std::vector<double>> save() const final;

  protected:
    /// Begins with nothing received and nothing unshot, or goes on from a saved state; certify() may read.
    /// `own_sizes`: of the vectors that own_numbers() gives. Throws Error{internal} for a state of other sizes, and
    /// what Adjoint::certify() throws.
    CertifiedSolver(SolveFrame& frame, std::initializer_list<std::size_t> own_sizes);

    /// What the solver saves beside weights, irradiance and unshot light.
    [[nodiscard]] virtual std::vector<std::vector<double>> own_numbers() const = 0;
    /// The same of the state to go on from, once; nothing at the beginning.
    [[nodiscard]] std::optional<std::vector<std::vector<double>>> take_own_numbers() { return std::exchange(own_, {}); }
    /// All that is emitted is unshot, but for chunks that see nothing: they have nobody to send it to.
    void begin_with_emission();

    SolveFrame& frame_;
    Transport& transport_;

  private:
    std::optional<std::vector<std::vector<double>>> own_;

  protected:
    Adjoint adjoint_;
    std::vector<Channels> irradiance_, unshot_;  ///< H without the patch's own part; U, in the solver's scale

  private:
    CertifiedSolver(SolveFrame& frame, std::optional<std::vector<std::vector<double>>> saved);
};

}  // namespace luxel
