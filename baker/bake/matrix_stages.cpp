#include "baker/bake/matrix_stages.h"

#include "baker/bake/stage_files.h"
#include "baker/bake/store_stage.h"
#include "baker/store/pooling.h"
#include "baker/store/strip_store.h"

namespace luxel {
namespace {

Closure close_matrix(const BakeOptions& options, const BakedMatrix& matrix) {
    const RayTallies& tallies = matrix.strips->tallies();
    const std::vector<std::uint64_t> rays(tallies.rays.begin(), tallies.rays.end());
    const std::vector<std::uint64_t> self(tallies.self.begin(), tallies.self.end());
    std::vector<std::uint64_t> open(tallies.open.begin(), tallies.open.end());
    for (std::size_t p = 0; p < open.size(); ++p) open[p] += tallies.back[p];
    return close_rows(*matrix.strips, {matrix.area_m2, rays, self, open}, {options.closure_iterations, 1e-9});
}

}  // namespace

MatrixKeys matrix_keys(const BakeOptions& options, const EvidenceRounds& evidence) {
    const Key strips = KeyBuilder("strips 3").key(evidence.key()).finish();
    return {strips, KeyBuilder("closure 2").key(strips).integer(options.closure_iterations).finish()};
}

BakedMatrix build_matrix(const BakeOptions& options, const BakedGeometry& g, const EvidenceRounds& evidence,
                         const BakeFolder& folder, const MemoryPlan& plan, StageClock& clock, BakeReport& report) {
    BakedMatrix matrix;
    const MatrixKeys keys = matrix_keys(options, evidence);
    for (const Patch& patch : g.patches.patches) matrix.area_m2.push_back(static_cast<double>(patch.area_m2));
    matrix.cache_bytes = plan.cache_bytes;
    clock.stage("pooling", [&] {
        clock.keeps(folder.patches(keys.strips));
        if (options.store != StoreKind::all) {
            matrix.estimator = evidence.estimator();
            // Rows of rays take a third of the bytes that the decoded blocks made of them take, and are much dearer.
            matrix.cache_bytes = plan.cache_bytes / 4;
            matrix.rows = std::make_unique<TracedRows>(*matrix.estimator, g.layout, evidence.all_levels(),
                                                       plan.cache_bytes - matrix.cache_bytes);
            return open_traced(options, folder, keys.strips, matrix, clock);
        }
        const auto place = folder.strips(keys.strips);
        clock.keeps(place);
        const bool wrote = pool_evidence(g.layout, evidence.ids(), evidence.files(), place, keys.strips,
                                         {plan.pooling_bytes, folder.root()}, clock.progress("files"));
        matrix.strips = std::make_unique<StripStore>(place, keys.strips, g.layout);
        return !wrote;
    });
    report.blocks = matrix.strips->blocks().size();
    report.pairs = matrix.strips->pair_count();
    report.store_bytes = matrix.strips->file_bytes();

    matrix.strip_key = keys.strips;
    matrix.key = keys.closure;
    clock.stage("closure", [&] {
        const auto path = folder.closure(matrix.key);
        clock.keeps(path);
        if (auto closure = load_closure(path, matrix.key, g.patches.count())) {
            matrix.closure = std::move(*closure);
            return true;
        }
        matrix.closure = close_matrix(options, matrix);
        save_closure(path, matrix.key, matrix.closure);
        return false;
    });
    report.closure = matrix.closure.report;
    return matrix;
}

}  // namespace luxel
