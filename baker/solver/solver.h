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

struct SolveOptions {
    double tolerance = 1e-3;         ///< stop when error_bound is at most this
    std::uint64_t max_reads = 1000;  ///< whole reads of the half matrix; beyond it the result is returned unconverged
    /// Called now and then with (bytes read, current bound).
    std::function<void(std::uint64_t, double)> progress;
};

struct SolveStep {
    std::uint64_t bytes_read = 0;
    double error_bound = 0;
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
