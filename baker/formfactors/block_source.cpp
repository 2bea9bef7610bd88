#include "baker/formfactors/block_source.h"

#include <algorithm>

namespace luxel {

ChunkNumber ChunkLayout::chunk_of(PatchNumber patch) const {
    // The last chunk that begins at or before the patch; empty chunks before it begin at the same number.
    const auto after = std::upper_bound(first_patch.begin(), first_patch.end(), patch);
    return static_cast<ChunkNumber>(after - first_patch.begin() - 1);
}

}  // namespace luxel
