/// What every solver takes and gives. Equation: B_i = M_i + rho_i / A_i * sum_j G_ij B_j, three channels at once.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "baker/formfactors/block_source.h"

namespace luxel {

/// Three channels in double: every sum over patches is done in these.
using Channels = std::array<double, 3>;

struct SolveInput {
    std::span<const Rgb> reflectance;    ///< per patch, 0..1
    std::span<const Channels> emission;  ///< M per patch, lm/m2: self-emission plus reflected direct light of lamps
};

struct SolveStep {
    std::uint64_t bytes_read = 0;
    double error_bound = 0;
};

/// All that a solver needs to go on from where it was, as plain numbers; which ones is the solver's own affair.
struct SolveState {
    std::string solver;                        ///< who wrote it
    std::uint64_t bytes_read = 0;              ///< that came from the disk
    std::uint64_t requested_bytes = 0;         ///< that were asked for, from the disk or a cache
    std::vector<SolveStep> history;            ///< so far
    std::vector<std::vector<double>> numbers;  ///< of the solver
};

/// A solve between two of its steps. Valid only during the call that hands it out.
class SolveView {
  public:
    virtual ~SolveView() = default;
    [[nodiscard]] virtual std::uint64_t bytes_read() const = 0;
    [[nodiscard]] virtual double error_bound() const = 0;
    /// H per patch, lm/m2, as SolveResult::irradiance if the solve ended here. `ambient`: with the light that is still
    /// on its way spread evenly over all surface, as much of it as the mean reflectance lets become: Cohen, Chen,
    /// Wallace, Greenberg 1988. A guess, for pictures.
    [[nodiscard]] virtual std::vector<Channels> irradiance(bool ambient) const = 0;
    /// For SolveOptions::resume. Costs a copy of the solver's vectors.
    [[nodiscard]] virtual SolveState state() const = 0;
};

struct SolveOptions {
    double tolerance = 1e-3;         ///< stop when error_bound is at most this
    std::uint64_t max_reads = 1000;  ///< whole reads of the half matrix; beyond it the result is returned unconverged
    /// Called after every step, on the caller's thread. False: stop; what is there is the result, not converged if the
    /// bound is not met.
    std::function<bool(const SolveView&)> step;
    /// Go on from here, with the same source, input and options as before: the result is the same, bit for bit, as that
    /// of a solve that never stopped. State of another solver, or of other sizes, is Error{internal}. Its numbers are
    /// gone after the call, so that no solve holds them twice.
    SolveState* resume = nullptr;
};

struct SolveResult {
    std::string solver;
    std::vector<Channels> radiosity;  ///< B per patch, lm/m2
    std::vector<Channels> unshot;     ///< part of B that the others have not received yet
    /// H per patch, lm/m2, also where nothing is reflected: B = M + rho H. All 0 when no patch reflects, since then no
    /// factor is needed to know B and none is read.
    std::vector<Channels> irradiance;
    /// Upper bound of sum A |B* - B| over sum A B*, the worst of the three channels; see shoot.h for how it is
    /// certified.
    double error_bound = 0;
    bool converged = false;
    double reads = 0;  ///< bytes read / bytes of the half matrix
    std::vector<SolveStep> history;
};

}  // namespace luxel
