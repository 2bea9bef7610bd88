/// Which two-sided patches need a second patch for their back. Exporters set doubleSided on closed solids too, whose
/// insides no light reaches; a thin round of rays from the back tells the two apart.
#pragma once
#include <vector>

#include "baker/patches/patch.h"
#include "baker/trace/tracer.h"
#include "baker/unwrap/atlas.h"

namespace luxel {

/// Per patch: true if its surface is two-sided and rays from its back met a front, or met something and also found the
/// open. Inside a closed solid they meet backs only; outside of a room's walls they meet nothing: neither needs a patch.
/// A pure function of geometry and stable ids. Threads: uses them all.
std::vector<bool> find_open_backs(const Scene& scene, const Atlas& atlas, const PatchSet& patches, const Tracer& tracer);

/// Per patch: is its surface two-sided, whether its back is open to anything or not?
std::vector<bool> find_all_backs(const Scene& scene, const PatchSet& patches);

}  // namespace luxel
