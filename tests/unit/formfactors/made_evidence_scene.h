/// Evidence of whole hand-made scenes, named by stable ids, for comparing one run with another.
#pragma once
#include <map>

#include "baker/core/parallel.h"
#include "baker/formfactors/ray_estimator.h"
#include "tests/support/scenes.h"

namespace luxel::test {

/// A closed room of 3 x 2.5 x 3 m at `shift` with a box, a ball, a two-sided sheet, a lamp under the ceiling, none of
/// them touching a wall; all paths begin with `name`.
inline SceneMaker& add_furnished_room(SceneMaker& maker, const std::string& name, const Vec3d& shift) {
    MadeMaterial sheet;
    sheet.double_sided = true;
    MadeMaterial lamp;
    lamp.nits = {100, 100, 100};
    return maker.add(name + "/walls", room({0, 0, 0}, {3, 2.5f, 3}), {}, shift)
        .add(name + "/box", moved(box(0.6f, 0.5f, 0.8f), {0.4f, 0.05f, 0.5f}), {}, shift)
        .add(name + "/ball", moved(icosphere(2, 0.3f), {2.2f, 0.5f, 2.1f}), {}, shift)
        .add(name + "/sheet", quad({1.4f, 0.3f, 1.2f}, {0, 0.9f, 0.2f}, {0.7f, 0, 0.5f}), sheet, shift)
        .add(name + "/lamp", quad({1.2f, 2.4f, 1.2f}, {0.6f, 0, 0}, {0, 0, 0.6f}), lamp, shift);
}

inline std::unique_ptr<Estimator> estimator_of(const Prepared& made, const RayEstimatorOptions& options = {}) {
    return make_ray_estimator(made.scene, made.atlas, made.patches, *made.tracer, options);
}

/// Records of every patch, by stable id, in replicate order.
inline std::map<PatchId, std::vector<EvidenceRecord>> evidence_of(const Prepared& made, const Estimator& estimator,
                                                                  LevelRange levels) {
    const auto ids = made.ids();
    std::vector<std::vector<EvidenceRecord>> found(ids.size());
    parallel_for(ids.size(), 8, [&](std::size_t p) {
        collect_records(estimator, ids, static_cast<PatchNumber>(p), levels, found[p]);
    });
    std::map<PatchId, std::vector<EvidenceRecord>> all;
    for (std::size_t p = 0; p < ids.size(); ++p) all[ids[p]] = std::move(found[p]);
    return all;
}

}  // namespace luxel::test
