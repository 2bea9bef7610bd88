/// What a bake will hold beside its geometry, from its options and that geometry.
#pragma once
#include "baker/bake/geometry_stages.h"
#include "baker/bake/memory_plan.h"

namespace luxel {

/// To be called right after the geometry was made: it counts what the process holds now. `report`: with the memory of the stages so far
/// (peak_bytes, geometry_bytes). Gives memory that the stages have freed back to the system.
MemoryDemand memory_demand(const BakeOptions& options, const BakedGeometry& geometry, const BakeReport& report, unsigned threads);

}  // namespace luxel
