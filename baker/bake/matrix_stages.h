/// The middle of the way: rays -> evidence files -> strips -> closure. On disk; nothing here keeps the matrix in memory.
#pragma once
#include "baker/bake/bake_folder.h"
#include "baker/bake/geometry_stages.h"
#include "baker/bake/memory_plan.h"
#include "baker/formfactors/closure.h"
#include "baker/store/strip_store.h"

namespace luxel {

struct BakedMatrix {
    std::unique_ptr<StripStore> strips;
    Closure closure;
    std::vector<double> area_m2;  ///< per patch
    Key key;                      ///< of everything above
};

BakedMatrix prepare_matrix(const BakeOptions& options, const BakedGeometry& geometry, const BakeFolder& folder,
                           const MemoryPlan& plan, StageClock& clock, BakeReport& report);

}  // namespace luxel
