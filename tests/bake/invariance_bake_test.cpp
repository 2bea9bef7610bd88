// The same bytes for any thread count and memory budget; the same light for any chunk size.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/bake/whole_bake.h"
#include "tests/support/solver_kinds.h"
#include "tests/support/temporary_folder.h"

namespace luxel::test {
namespace {

class Invariance : public testing::TestWithParam<const char*> {};

TEST_P(Invariance, ThreadsDoNotChangeAByte) {
    const TemporaryFolder folder;
    BakeOptions options = small_options(sample(GetParam()), {});
    options.threads = 1;
    const FinishedBake one = bake_in(folder / "one", options);
    options.threads = 2;
    const FinishedBake two = bake_in(folder / "two", options);
    EXPECT_GE(one.outputs.size(), 3u);  // model, sidecar, pages
    EXPECT_GE(one.stored.size(), 6u);
    EXPECT_EQ(differences(one.outputs, two.outputs), "");
    EXPECT_EQ(differences(one.stored, two.stored), "");
}

TEST_P(Invariance, MemoryDoesNotChangeAByte) {
    const TemporaryFolder folder;
    BakeOptions options = small_options(sample(GetParam()), folder / "probe.glb");
    // The floor counts what the process holds already, which grows with the first pictures: the second answer is final.
    options.memory_bytes = std::uint64_t{4} << 30;
    const FinishedBake much = bake_in(folder / "much", options);
    options.memory_bytes = smallest_memory(options) + (std::uint64_t{4} << 20);
    const FinishedBake little = bake_in(folder / "little", options);
    EXPECT_LT(little.report.budget_bytes, much.report.budget_bytes);
    EXPECT_EQ(differences(much.outputs, little.outputs), "");
    EXPECT_EQ(differences(much.stored, little.stored), "");
}

TEST_P(Invariance, ChunksDoNotChangeTheLight) {
    const TemporaryFolder folder;
    BakeOptions options = small_options(sample(GetParam()), {});
    options.unwrap.texels_per_metre = GetParam() == std::string("cornell_box") ? 24 : 4;  // half a metre against 4
    options.tolerance = 1e-7;
    // A fixed plan of rays: a plan that follows the light is rounded to powers of two from sums whose last bits the chunks
    // decide, so a patch may get half or twice the rays.
    options.importance = false;
    options.chunk_patches = 32;
    const FinishedBake fine = bake_in(folder / "fine", options);
    options.chunk_patches = 400;
    const FinishedBake coarse = bake_in(folder / "coarse", options);
    EXPECT_GT(fine.report.chunks, coarse.report.chunks);
    EXPECT_EQ(fine.report.pairs, coarse.report.pairs);
    EXPECT_EQ(fine.report.evidence_rays, coarse.report.evidence_rays);
    const std::vector<float> expected = stored_irradiance(folder / "coarse/work"), found = stored_irradiance(folder / "fine/work");
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t k = 0; k < found.size(); ++k)
        ASSERT_NEAR(found[k], expected[k], 1e-5f * std::fabs(expected[k])) << "value " << k;
}

INSTANTIATE_TEST_SUITE_P(Samples, Invariance, testing::Values("two_rooms", "cornell_box"));

TEST(InvarianceDraft, ThreadsDoNotChangeAByte) {
    const TemporaryFolder folder;
    BakeOptions options = small_options(sample("two_rooms"), {});
    options.gather_rays = 0;
    options.threads = 1;
    const FinishedBake one = bake_in(folder / "one", options);
    options.threads = 2;
    const FinishedBake two = bake_in(folder / "two", options);
    EXPECT_EQ(differences(one.outputs, two.outputs), "");
    EXPECT_EQ(differences(one.stored, two.stored), "");
}

class SolverInvariance : public testing::TestWithParam<SolverKind> {
  protected:
    static BakeOptions options() {
        BakeOptions options = small_options(sample("corridor_4"), {});
        options.unwrap.page_size = 128;
        options.gather_rays = 0;
        options.solver = GetParam();
        return options;
    }
};

TEST_P(SolverInvariance, ThreadsAndMemoryDoNotChangeAByte) {
    const TemporaryFolder folder;
    BakeOptions options = SolverInvariance::options();
    options.threads = 1;
    options.memory_bytes = std::uint64_t{4} << 30;
    const FinishedBake one = bake_in(folder / "one", options);
    EXPECT_GT(one.report.chunks, 4u);
    options.threads = 3;
    options.output = folder / "probe.glb";
    options.memory_bytes = smallest_memory(options) + (std::uint64_t{4} << 20);
    const FinishedBake other = bake_in(folder / "other", options);
    EXPECT_EQ(differences(one.outputs, other.outputs), "");
    EXPECT_EQ(differences(one.stored, other.stored), "");
}

TEST_P(SolverInvariance, ChunksDoNotChangeTheLight) {
    const TemporaryFolder folder;
    BakeOptions options = SolverInvariance::options();
    options.tolerance = 1e-8;
    options.importance = false;  // a fixed plan of rays, as above
    const FinishedBake fine = bake_in(folder / "fine", options);
    options.chunk_patches = 512;
    const FinishedBake coarse = bake_in(folder / "coarse", options);
    EXPECT_TRUE(fine.report.converged && coarse.report.converged);
    EXPECT_GT(fine.report.chunks, coarse.report.chunks);
    const std::vector<float> expected = stored_irradiance(folder / "coarse/work"), found = stored_irradiance(folder / "fine/work");
    ASSERT_EQ(found.size(), expected.size());
    // Relative to the light there or to the mean: the tolerance is one of all light, which dark texels have little of.
    double mean = 0;
    for (const float value : expected) mean += static_cast<double>(value) / static_cast<double>(expected.size());
    for (std::size_t k = 0; k < found.size(); ++k)
        ASSERT_NEAR(found[k], expected[k], 1e-6 * std::max<double>(std::fabs(expected[k]), mean)) << "value " << k;
}

INSTANTIATE_TEST_SUITE_P(All, SolverInvariance, test::all_solvers(), test::solver_test_name);

}  // namespace
}  // namespace luxel::test
