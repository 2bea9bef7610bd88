/// What to change where a budget will not hold.
#pragma once
#include <string>
#include <vector>

#include "baker/bake/memory_plan.h"
#include "baker/plan/forecast.h"

namespace luxel {

struct Advice {
    std::string budget;   ///< the option that will not hold
    std::string problem;  ///< by how much
    std::string change;   ///< options to add or change; empty: none is enough
    std::string effect;   ///< what is foreseen with them
    std::string cost;     ///< in error and time
};

/// Of --memory: the least change first that brings the floor under the budget. Empty if it holds. Pure.
std::vector<Advice> advise_memory(std::uint64_t budget_bytes, const MemoryDemand& demand);

/// Of a wish for bytes on the disk, 0: none. Pure.
std::vector<Advice> advise_disk(std::uint64_t budget_bytes, const Forecast& forecast);

/// Of a wish for seconds, 0: none; `fastest`: of all choices. Pure.
std::vector<Advice> advise_time(double budget_s, const Forecast& fastest, double texels_per_metre);

}  // namespace luxel
