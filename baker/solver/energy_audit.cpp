#include "baker/solver/energy_audit.h"

#include <algorithm>
#include <cmath>

#include "formats/base/error.h"

namespace luxel {

EnergyAudit audit_energy(std::span<const double> area_m2, std::span<const double> row_open_m2, const SolveInput& input,
                         const SolveResult& result) {
    const std::size_t count = area_m2.size();
    if (row_open_m2.size() != count || input.emission.size() != count || input.reflectance.size() != count ||
        result.radiosity.size() != count || result.unshot.size() != count || result.irradiance.size() != count)
        throw Error(ErrorCode::internal, "energy audit", "all arrays need one entry per patch");
    EnergyAudit audit;
    for (std::size_t c = 0; c < 3; ++c) {
        const auto reflectance = [&](std::size_t i) {
            return static_cast<double>(input.reflectance[i][static_cast<int>(c)]);
        };
        bool reflects = false;
        for (std::size_t i = 0; i < count; ++i) reflects = reflects || reflectance(i) > 0;
        for (std::size_t i = 0; i < count; ++i) {
            audit.emitted_lm[c] += area_m2[i] * input.emission[i][c];
            if (reflects) {
                audit.absorbed_lm[c] += area_m2[i] * (1 - reflectance(i)) * result.irradiance[i][c];
                audit.lost_lm[c] += row_open_m2[i] * (result.radiosity[i][c] - result.unshot[i][c]);
                audit.remaining_lm[c] += area_m2[i] * result.unshot[i][c];
            } else {
                audit.absorbed_lm[c] += (area_m2[i] - row_open_m2[i]) * result.radiosity[i][c];
                audit.lost_lm[c] += row_open_m2[i] * result.radiosity[i][c];
            }
        }
        if (!(audit.emitted_lm[c] > 0)) continue;
        const double rest = audit.emitted_lm[c] - audit.absorbed_lm[c] - audit.lost_lm[c] - audit.remaining_lm[c];
        audit.imbalance = std::max(audit.imbalance, std::abs(rest) / audit.emitted_lm[c]);
    }
    return audit;
}

}  // namespace luxel
