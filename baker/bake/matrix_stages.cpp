#include "baker/bake/matrix_stages.h"

#include "baker/bake/stage_files.h"
#include "baker/formfactors/evidence.h"
#include "baker/formfactors/ray_estimator.h"
#include "baker/store/pooling.h"

namespace luxel {
namespace {

struct EvidenceSet {
    std::vector<std::filesystem::path> files;
    Key key;
};

std::vector<PatchId> patch_ids(const PatchSet& patches) {
    std::vector<PatchId> ids;
    for (const Patch& patch : patches.patches) ids.push_back(patch.id);
    return ids;
}

EvidenceSet collect_evidence(const BakeOptions& options, const BakedGeometry& g, std::span<const PatchId> ids,
                             const BakeFolder& folder, StageClock& clock, BakeReport& report) {
    const auto estimator =
        make_ray_estimator(g.scene, g.atlas, g.patches, *g.tracer, {options.seed, options.replicates});
    const LevelPlan plan = uniform_plan(g.patches.count(), options.replicates, options.rays);
    KeyBuilder key("evidence 1");
    key.key(g.layout_key).key(estimator->identity());
    for (const LevelRange& levels : plan.levels) key.integer(levels.first).integer(levels.last);
    EvidenceSet evidence;
    evidence.key = key.finish();
    const auto place = folder.evidence(evidence.key);
    report.evidence_rays = planned_rays(plan, options.replicates, 0, g.layout.patch_count());
    clock.stage("evidence", [&] {
        ProgressCounter progress(report.evidence_rays, clock.progress("rays"));
        bool reused = true;
        for (ChunkNumber chunk = 0; chunk < g.layout.chunk_count(); ++chunk) {
            evidence.files.push_back(BakeFolder::evidence_file(place, chunk));
            if (block_file_is_whole(evidence.files.back(), FileKind::evidence, evidence_version, evidence.key)) {
                progress.add(planned_rays(plan, options.replicates, g.layout.first_patch[chunk],
                                          g.layout.first_patch[chunk + 1]));
                continue;
            }
            reused = false;
            write_chunk_evidence(*estimator, g.layout, ids, chunk, plan, evidence.files.back(), evidence.key, &progress);
        }
        return reused;
    });
    report.evidence_seconds = clock.last_seconds();
    report.evidence_rounds = 1;
    return evidence;
}

Closure close_matrix(const BakeOptions& options, const BakedMatrix& matrix) {
    const StripTallies& tallies = matrix.strips->tallies();
    const std::vector<std::uint64_t> rays(tallies.rays.begin(), tallies.rays.end());
    const std::vector<std::uint64_t> self(tallies.self.begin(), tallies.self.end());
    std::vector<std::uint64_t> open(tallies.open.begin(), tallies.open.end());
    for (std::size_t p = 0; p < open.size(); ++p) open[p] += tallies.back[p];
    return close_rows(*matrix.strips, {matrix.area_m2, rays, self, open}, {options.closure_iterations, 1e-9});
}

}  // namespace

BakedMatrix prepare_matrix(const BakeOptions& options, const BakedGeometry& g, const BakeFolder& folder,
                           const MemoryPlan& plan, StageClock& clock, BakeReport& report) {
    const std::vector<PatchId> ids = patch_ids(g.patches);
    const EvidenceSet evidence = collect_evidence(options, g, ids, folder, clock, report);
    BakedMatrix matrix;
    const Key strip_key = KeyBuilder("strips 1").key(evidence.key).finish();
    const auto place = folder.strips(strip_key);
    clock.stage("pooling", [&] {
        for (const Patch& patch : g.patches.patches) matrix.area_m2.push_back(static_cast<double>(patch.area_m2));
        const bool wrote = pool_evidence(g.layout, ids, evidence.files, evidence.key, place, strip_key,
                                         {plan.pooling_bytes, folder.root()}, clock.progress("files"));
        matrix.strips = std::make_unique<StripStore>(place, strip_key, g.layout);
        return !wrote;
    });
    report.blocks = matrix.strips->blocks().size();
    report.pairs = matrix.strips->pair_count();
    report.store_bytes = matrix.strips->file_bytes();

    matrix.key = KeyBuilder("closure 1").key(strip_key).integer(options.closure_iterations).finish();
    clock.stage("closure", [&] {
        const auto path = folder.closure(matrix.key);
        if (auto closure = load_closure(path, matrix.key, g.patches.count())) {
            matrix.closure = std::move(*closure);
            return true;
        }
        matrix.closure = close_matrix(options, matrix);
        save_closure(path, matrix.key, matrix.closure);
        return false;
    });
    report.closure_iterations = matrix.closure.report.iterations;
    report.closure_row_error_before = matrix.closure.report.max_row_error_before;
    report.closure_row_error_after = matrix.closure.report.max_row_error_after;
    return matrix;
}

}  // namespace luxel
