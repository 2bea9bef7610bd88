/// The middle of the way: evidence files -> strips -> closure. On disk; nothing here keeps the matrix in memory. Where not all is
/// stored there are no evidence files, and strips are traced again when they are read (store_stage.h).
#pragma once
#include "baker/bake/bake_folder.h"
#include "baker/bake/evidence_rounds.h"
#include "baker/bake/geometry_stages.h"
#include "baker/bake/memory_plan.h"
#include "baker/formfactors/closure.h"
#include "baker/store/closed_matrix.h"
#include "baker/store/traced_rows.h"

namespace luxel {

struct BakedMatrix {
    std::shared_ptr<const Estimator> estimator;  ///< of `rows`
    std::unique_ptr<TracedRows> rows;            ///< null where all is stored
    std::unique_ptr<MatrixStore> strips;
    std::uint64_t cache_bytes = 0;  ///< what a reader may keep in decoded blocks
    Closure closure;
    std::vector<double> area_m2;  ///< per patch
    Key strip_key;                ///< names the strips
    Key key;                      ///< of everything above
};

/// Names of what build_matrix() leaves in the bake folder, known before it is built.
struct MatrixKeys {
    Key strips, closure;
};
MatrixKeys matrix_keys(const BakeOptions& options, const EvidenceRounds& evidence);

/// Pools and closes everything traced so far. Stages "pooling" and "closure".
BakedMatrix build_matrix(const BakeOptions& options, const BakedGeometry& geometry, const EvidenceRounds& evidence,
                         const BakeFolder& folder, const MemoryPlan& plan, StageClock& clock, BakeReport& report);

}  // namespace luxel
