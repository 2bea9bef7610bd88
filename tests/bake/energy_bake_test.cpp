// Energy: what is emitted is absorbed or lost, in every sample.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/bake/whole_bake.h"
#include "tests/support/temporary_folder.h"

namespace luxel::test {
namespace {

class Energy : public testing::TestWithParam<const char*> {};

TEST_P(Energy, EmittedIsAbsorbedOrLost) {
    const TemporaryFolder folder;
    BakeOptions options = small_options(sample(GetParam()), folder / "out.glb");
    options.unwrap.texels_per_metre = 0;
    options.unwrap.page_size = 128;
    options.gather_rays = 0;
    options.tolerance = 1e-4;
    const BakeReport report = bake(options);
    EXPECT_TRUE(report.converged);
    EXPECT_LE(energy_imbalance(report), 1e-3);
    for (std::size_t c = 0; c < 3; ++c) {
        EXPECT_GT(report.emitted_lm[c], 0);
        EXPECT_GE(report.absorbed_lm[c], 0);
        EXPECT_GE(report.lost_lm[c], -1e-9 * report.emitted_lm[c]);
    }
    for (const PagePixels& page : lightmap_pages(report))
        for (const auto& pixel : page.pixels)
            for (std::size_t c = 0; c < 3; ++c) ASSERT_TRUE(std::isfinite(pixel[c]) && pixel[c] >= 0);
}

INSTANTIATE_TEST_SUITE_P(Samples, Energy,
                         testing::Values("cornell_box", "furnace", "sphere", "two_squares_parallel",
                                         "two_squares_perpendicular", "two_rooms", "corridor_4", "corridor_16",
                                         "corridor_64"));

}  // namespace
}  // namespace luxel::test
