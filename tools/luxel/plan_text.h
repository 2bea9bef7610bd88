/// A plan for people and for programs (docs/plan.md).
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "baker/plan/plan.h"

namespace luxel {

std::string plan_text(const PlanReport& plan);
/// `settings`: name and value of each option.
std::string plan_json(const PlanReport& plan, const std::vector<std::pair<std::string, std::string>>& settings);

}  // namespace luxel
