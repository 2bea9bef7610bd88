/// The results of a sweep as one page of HTML that needs nothing else: no network, no script, no graphics processor; light or dark as the
/// reader's system has it (docs/sweep.md).
///
/// Threads  pure. The same results give the same bytes.
#pragma once
#include <string>

#include "baker/sweep/sweep_tables.h"

namespace luxel {

std::string sweep_page(const SweepResult& result, const SweepSummary& summary);

}  // namespace luxel
