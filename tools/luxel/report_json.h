/// BakeReport -> the JSON of --report. The schema is docs/report.md; "schema" is raised when a member changes its meaning.
#pragma once
#include <string>

#include "baker/bake/report.h"

namespace luxel {

std::string report_json(const BakeReport& report);

}  // namespace luxel
