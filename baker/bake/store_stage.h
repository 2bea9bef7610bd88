/// What of a matrix stays on the disk: --store.
#pragma once
#include "baker/bake/matrix_stages.h"

namespace luxel {

/// Sets matrix.strips to a source that traces what is not kept. The directory of blocks is a stage result: found once, then there. For
/// `hot` the kept blocks are chosen and written. True if everything was there already. Killed at any place, the next run goes on
/// from the directory and the strips that are whole.
bool open_traced(const BakeOptions& options, const BakeFolder& folder, const Key& strips, BakedMatrix& matrix, StageClock& clock);

/// Removes what another choice has left of this matrix: strips and evidence where not all is stored, else directory and kept blocks.
void remove_other_store(const BakeOptions& options, const BakeFolder& folder, const Key& strips, std::span<const Key> evidence);

}  // namespace luxel
