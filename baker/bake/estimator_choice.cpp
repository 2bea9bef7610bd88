#include "baker/bake/estimator_choice.h"

#include "baker/formfactors/hemicube_estimator.h"
#include "baker/formfactors/hemicube_weights.h"
#include "baker/formfactors/level_plan.h"
#include "baker/formfactors/ray_estimator.h"

namespace luxel {

std::unique_ptr<Estimator> make_estimator(const BakeOptions& options, const BakedGeometry& g) {
    if (options.estimator == EstimatorKind::hemicube)
        return make_hemicube_estimator(g.scene, g.atlas, g.patches, *g.tracer, {options.seed, options.hemicube_resolution});
    return make_ray_estimator(g.scene, g.atlas, g.patches, *g.tracer, {options.seed, options.replicates});
}

LevelRange first_levels(const BakeOptions& options, std::uint64_t rays) {
    if (options.estimator == EstimatorKind::hemicube) return {0, hemicube_level};
    return uniform_plan(1, options.replicates, rays).levels.front();
}

}  // namespace luxel
