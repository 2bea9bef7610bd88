/// Operations on a finished PatchSet. Deterministic.
#pragma once
#include <span>
#include <vector>

#include "baker/patches/patch.h"

namespace luxel {

/// Gives patch p the number new_number[p] everywhere. Throws Error{internal} unless new_number is a permutation.
void renumber(PatchSet& set, std::span<const PatchNumber> new_number);

/// Appends, for every front patch p with open[p], a patch for its back: same surface, reversed normal, an id of its
/// own, other_side linked both ways. In the order of the fronts. `open` has one entry per patch of the set, which has
/// no backs yet (else Error{internal}).
PatchSet add_back_sides(PatchSet set, const std::vector<bool>& open);

/// Id of the back of the patch with this id.
PatchId back_id(PatchId front);

/// Throws Error{internal} if an id appears twice.
void check_ids(const PatchSet& set);

}  // namespace luxel
