/// A bake that is to end early: what each stage asks, and what the user is told. The stages decide where they can end.
///
/// evidence   ends at the next chunk; the round counts as not traced, what was traced stays in the bake folder.
/// solve      ends at its next step; a checkpoint takes the place of the solution.
/// accuracy   is left out unless the bake folder has it.
/// light      pages that are not gathered yet are interpolated from the patches, and not kept.
/// verify     is left out.
/// Nothing that was cut short is kept under the name of something whole, so the next run ends in the same bytes as one that
/// never stopped.
#pragma once
#include "baker/bake/bake.h"

namespace luxel {

inline bool is_stopping(const BakeOptions& options) { return options.stop && options.stop->is_asked(); }

/// Notes that stage `where` was cut short, and what of it is there. It ends at the first one that says so; what others say is added.
void note_stop(BakeReport& report, const std::string& where, const std::string& what);

/// Throws Error{stopped_early}: no round of rays is complete, so there is no light to write.
[[noreturn]] void refuse_without_light(const BakeOptions& options, const std::string& what);

/// The warning "stopped", when everything else is known.
void warn_of_stop(const BakeOptions& options, BakeReport& report);

}  // namespace luxel
