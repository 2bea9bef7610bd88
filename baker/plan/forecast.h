/// How much of everything a bake will make, and how long it will take here.
#pragma once
#include <span>
#include <string>

#include "baker/bake/geometry_stages.h"

namespace luxel {

/// Options of a bake under a name for the user, such as that of a preset.
struct NamedOptions {
    std::string name;
    BakeOptions options;
};

struct ForecastSeconds {
    double geometry = 0;  ///< as it took just now
    double matrix = 0;    ///< evidence to the solve and its standard error
    double light = 0;     ///< of texels
    double write = 0;
    [[nodiscard]] double total() const { return geometry + matrix + light + write; }
};

struct Forecast {
    std::string name;
    std::uint64_t evidence_rays = 0, gather_rays = 0;  ///< of texels: without those that follow on
    std::uint64_t pairs = 0;
    std::uint64_t matrix_bytes = 0;  ///< on disk, with --store all
    std::uint64_t peak_bytes = 0;    ///< most that will be resident, geometry included
    ForecastSeconds seconds;         ///< on this machine, with as many threads as now
};

/// Traces samples of less than two seconds in all. `options` must lead to this geometry, `geometry_seconds`: what making it took.
/// Threads: uses them all. But for times a pure function. Constants are measured: docs/plan.md, tests/bake/forecast_test.py.
Forecast forecast(const NamedOptions& options, const BakedGeometry& geometry, double geometry_seconds);

/// The last of `choices`, which rise in quality and time, that takes no more than `seconds`; the first where none does.
Forecast best_within(double seconds, std::span<const NamedOptions> choices, const BakedGeometry& geometry, double geometry_seconds);

}  // namespace luxel
