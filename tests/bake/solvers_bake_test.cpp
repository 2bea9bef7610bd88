// The same light by every solver, through the store, with a cache that holds only a part of it.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/bake/whole_bake.h"
#include "tests/support/temporary_folder.h"

namespace luxel::test {
namespace {

TEST(SolversBake, FindTheSameLight) {
    const TemporaryFolder folder;
    constexpr double tolerance = 1e-4;
    std::vector<Channels> first;
    for (const std::string_view name : solver_names()) {
        SCOPED_TRACE(name);
        const std::filesystem::path place = folder / std::string(name);
        BakeOptions options = small_options(sample("corridor_4"), place / "out" / "scene.glb");
        options.importance = false;  // one plan of rays, so one matrix
        options.chunk_patches = 64;
        options.tolerance = tolerance;
        options.solver = *solver_kind(name);
        options.work = place / "work";
        std::filesystem::create_directories(place / "out");
        const BakeReport report = bake(options);
        EXPECT_EQ(report.solver, name);
        EXPECT_TRUE(report.converged);
        EXPECT_LE(report.error_bound, tolerance);
        EXPECT_LT(energy_imbalance(report), 1e-3);
        const SolveResult solution = stored_solution(options.work, report.patches);
        if (first.empty()) first = solution.radiosity;
        double difference = 0, sum = 0;
        for (std::size_t p = 0; p < first.size(); ++p)
            difference += std::fabs(solution.radiosity[p][1] - first[p][1]), sum += first[p][1];
        EXPECT_LT(difference / sum, 5 * tolerance);  // both within the bound, which is weighted by area
        std::printf("%s: %zu patches, %.1f reads, bound %.1e, differs from shoot by %.1e\n", report.solver.c_str(),
                    first.size(), report.reads, report.error_bound, difference / sum);
    }
    EXPECT_FALSE(solver_kind("radiosity").has_value());
}

}  // namespace
}  // namespace luxel::test
