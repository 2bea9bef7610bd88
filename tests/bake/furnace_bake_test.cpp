// A closed cube whose walls all emit M and reflect rho: B = M / (1 - rho) everywhere, and H = B in the lightmap.
#include <gtest/gtest.h>

#include "tests/bake/whole_bake.h"
#include "tests/support/temporary_folder.h"

namespace luxel::test {
namespace {

class Furnace : public testing::TestWithParam<double> {};

TEST_P(Furnace, EveryPatchAndTexelHasTheClosedForm) {
    const TemporaryFolder folder;
    const double rho = GetParam();
    const auto input = edited_sample("furnace", folder / "scene", [&](nlohmann::json& document) {
        document["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = {rho, rho, rho, 1.0};
    });
    BakeOptions options = small_options(input, folder / "out.glb");
    options.work = folder / "work";
    options.tolerance = 1e-5;
    const BakeReport report = bake(options);
    EXPECT_TRUE(report.converged);
    EXPECT_LE(report.error_bound, options.tolerance);
    EXPECT_GT(report.chunks, 1u);

    const double expected = 1 / (1 - rho);  // M = 1 lm/m2
    const SolveResult solution = stored_solution(options.work, report.patches);
    for (const Channels& radiosity : solution.radiosity)
        for (const double b : radiosity) ASSERT_NEAR(b, expected, 1e-3 * expected);
    std::size_t covered = 0;
    for (const PagePixels& page : lightmap_pages(report))
        for (const auto& pixel : page.pixels) {
            if (pixel[0] == 0) continue;  // nothing there
            ++covered;
            for (std::size_t c = 0; c < 3; ++c) ASSERT_NEAR(pixel[c], expected, 1e-3 * expected);
        }
    EXPECT_GE(covered, report.texels);
    for (const float h : stored_irradiance(options.work)) ASSERT_NEAR(h, expected, 1e-3 * expected);
}

INSTANTIATE_TEST_SUITE_P(Reflectances, Furnace, testing::Values(0.0, 0.5, 0.9, 0.99));

TEST(FurnaceDraft, InterpolatedLightIsTheSame) {
    const TemporaryFolder folder;
    BakeOptions options = small_options(sample("furnace"), folder / "out.glb");
    options.gather_rays = 0;
    options.tolerance = 1e-5;
    const BakeReport report = bake(options);
    for (const PagePixels& page : lightmap_pages(report))
        for (const auto& pixel : page.pixels) {
            if (pixel[0] == 0) continue;  // nothing there
            for (std::size_t c = 0; c < 3; ++c) ASSERT_NEAR(pixel[c], 2.0, 2e-3);
        }
}

}  // namespace
}  // namespace luxel::test
