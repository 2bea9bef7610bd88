#include "tests/support/baked_problem.h"

#include "baker/formfactors/level_plan.h"

namespace luxel::test {

BakedProblem bake_to_matrix(const BakeOptions& o) {
    BakedProblem p;
    StageClock clock(o, p.report);
    const BakeFolder folder(o.work, o.output);
    p.geometry = prepare_geometry(o, folder, clock, p.report);
    EvidenceRounds evidence(o, *p.geometry, folder);
    evidence.add(uniform_plan(p.geometry->patches.count(), o.replicates, o.rays), clock, p.report);
    MemoryPlan plan;
    plan.pooling_bytes = std::uint64_t{1} << 30;
    p.matrix = build_matrix(o, *p.geometry, evidence, folder, plan, clock, p.report);
    p.sources = light_patches(o, *p.geometry, folder, clock, p.report);
    for (const Patch& patch : p.geometry->patches.patches) p.reflectance.push_back(patch.reflectance);
    return p;
}

}  // namespace luxel::test
