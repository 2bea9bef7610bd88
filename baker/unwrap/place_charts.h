/// Where charts lie on the pages: copies of a mesh as blocks of one arrangement, all others one by one.
/// Pure and deterministic.
#pragma once
#include <vector>

#include "baker/unwrap/atlas.h"
#include "baker/unwrap/mesh_copies.h"
#include "formats/base/error.h"

namespace luxel {

/// Sets page, x, y of every chart, copy_blocks and page_count. Charts of objects without a lightmap lie on pages of their own, behind the
/// others. The charts of all instances of a group have the same sizes in the same
/// order. A group whose charts do not fit on one page together gets no blocks, and a warning "copies-without-block".
void place_charts(const Scene& scene, const std::vector<CopyGroup>& groups, Atlas& atlas, std::vector<Warning>& warnings);

}  // namespace luxel
