// Joined seams: both sides read the same light, nothing else changes, and what parts the light in truth stays.
#include "baker/output/seam_join.h"

#include <gtest/gtest.h>

#include "baker/core/parallel.h"
#include "formats/base/error.h"
#include "tests/unit/output/seam_scene.h"

namespace luxel::test {
namespace {

SeamScene tiles(const std::vector<MadeMesh>& meshes, const std::vector<FlatLayout>& layouts,
                std::uint32_t padding = 2) {
    SceneMaker maker;
    for (std::size_t m = 0; m < meshes.size(); ++m) maker.add("tile" + std::to_string(m), meshes[m]);
    Scene scene = maker.build();
    Atlas atlas = flat_atlas(scene, layouts, 128, padding);
    return {std::move(scene), std::move(atlas)};
}

/// A square of 4 x 4 m cut at x = 2, the halves on grids of their own.
SeamScene cut_square() { return tiles({tile(0, 0, 2, 4), tile(2, 0, 2, 4)}, {{8, 0.2}, {5, -0.5}}); }

/// Mean difference of the sides along x = 2, relative to the mean, walked in space and read on the pages.
double jump_at_cut(const SeamScene& s, const LitPages& pages) {
    double jump = 0, light = 0;
    for (int k = 0; k < 1000; ++k) {
        const Vec3d at = Vec3d(2, 0, 4 * (k + 0.5) / 1000) - s.scene.origin;
        const double a = static_cast<double>(luminance(pages.read(0, place_of(s, 0, at)))),
                     b = static_cast<double>(luminance(pages.read(0, place_of(s, 2, at))));
        jump += std::abs(a - b);
        light += (a + b) / 2;
    }
    return jump / light;
}

Rgb gradient(const Vec3f& at) { return {1 + 3 * at.x + at.z, 10 + at.x - 2 * at.z, 0.01f * at.x * at.x}; }

TEST(SeamJoin, ACutSquareUnderAGradient) {
    const SeamScene s = cut_square();
    LitPages pages = paint(s, [](const Vec3f& at, std::uint32_t) { return gradient(at); });
    const double before = jump_at_cut(s, pages);
    const SeamJump jump = join(s.samples(), pages);
    const double after = jump_at_cut(s, pages);
    EXPECT_GT(before, 0.005);
    EXPECT_LT(after, before / 10);
    EXPECT_NEAR(jump.before, before, 0.02 * before) << "the report's measure against the one walked in space";
    EXPECT_LT(jump.after, jump.before / 10);
    EXPECT_NEAR(jump.length_texels, 4 * 8, 0.1);
    EXPECT_GT(jump.texels, 50u);
}

TEST(SeamJoin, AStepBetweenChartsBecomesWhatOneChartWouldShow) {
    // Light of 1 and 2 on tiles whose border lies on lines of the grid: the padding gives in, the surface keeps its
    // values.
    const SeamScene s = tiles({tile(0, 0, 2, 4), tile(2, 0, 2, 4)}, {{8, 0}, {8, 0}});
    LitPages pages = paint(s, [](const Vec3f&, std::uint32_t object) { return Rgb(1, 1, 1) * (object ? 2.0f : 1.0f); });
    const LitPages before = pages;
    join(s.samples(), pages);
    EXPECT_LT(jump_at_cut(s, pages), 0.02);
    for (std::size_t t = 0; t < pages.values[0].size(); ++t) {
        if (before.masks[0][t] != texel_covered) continue;
        EXPECT_NEAR(pages.values[0][t].x, before.values[0][t].x, 0.035 * static_cast<double>(before.values[0][t].x));
    }
    EXPECT_NEAR(pages.read(0, place_of(s, 0, Vec3d(2, 0, 2) - s.scene.origin)).x, 1.5f, 0.02f);
}

TEST(SeamJoin, OnlyWhatIsReadAtTheSeamChanges) {
    const SeamScene s = cut_square();
    const LitPages before = paint(s, [](const Vec3f& at, std::uint32_t) { return gradient(at); });
    LitPages pages = before;
    join(s.samples(), pages);
    for (const Texel& texel : s.texels.pages[0].texels) {
        const std::size_t at = std::size_t{texel.y} * pages.size + texel.x;
        // Its centre in space, whichever triangle of the tile it is measured by.
        const Vec3d centre = position_at(s, s.atlas.charts[texel.chart].object * 2, {texel.x + 0.5f, texel.y + 0.5f});
        const double texel_m = texel.chart ? 1.0 / 5 : 1.0 / 8;
        // Farther than a bilinear filter reaches across the corner of a square.
        if (std::abs(centre.x + s.scene.origin.x - 2) > std::sqrt(2.0) * texel_m) {
            EXPECT_EQ(pages.values[0][at], before.values[0][at]);
        }
    }
    EXPECT_EQ(pages.masks, before.masks);
}

TEST(SeamJoin, ABallUnwrappedIntoCharts) {
    const MadeMesh ball = icosphere(4, 1);
    const SeamScene s = unwrapped(ball, ball.positions, 12, 128);
    ASSERT_GT(s.atlas.charts.size(), 1u);
    LitPages pages =
        paint(s, [](const Vec3f& at, std::uint32_t) { return Rgb(1.2f + at.x, 1.1f + at.y, 1.3f + at.z); });
    const SeamJump jump = join(s.samples(), pages);
    EXPECT_GT(jump.before, 0.005);
    EXPECT_LT(jump.after, jump.before / 5);
}

TEST(SeamJoin, AHardCreaseKeepsEveryBit) {
    const SeamScene s = unwrapped(box(2, 2, 2), {}, 8, 128);
    LitPages pages = paint(s, [](const Vec3f& at, std::uint32_t) { return gradient(at); });
    const LitPages before = pages;
    const SeamJump jump = join(s.samples(), pages);
    EXPECT_EQ(pages.values, before.values);
    EXPECT_EQ(jump.texels, 0u);
    EXPECT_EQ(jump.length_texels, 0);
}

TEST(SeamJoin, AChartWithoutSeamsKeepsEveryBitBesideOneWithSeams) {
    const SeamScene s = tiles({tile(0, 0, 2, 4), tile(2, 0, 2, 4), tile(9, 0, 2, 4)}, {{8, 0.2}, {5, -0.5}, {6, 0}});
    LitPages pages = paint(s, [](const Vec3f& at, std::uint32_t) { return gradient(at); });
    const LitPages before = pages;
    EXPECT_GT(join(s.samples(), pages).texels, 0u);
    const Chart& alone = s.atlas.charts[2];
    for (std::uint32_t y = 0; y < pages.size; ++y)
        for (std::uint32_t x = alone.x; x < alone.x + alone.width; ++x)
            EXPECT_EQ(pages.values[0][y * pages.size + x], before.values[0][y * pages.size + x]);
}

/// Floors on both sides of a wall of `thickness` that stands on their seam.
SeamScene floor_with_wall(float thickness) {
    MadeMesh wall = moved(box(thickness, 3, 6), {2 - thickness / 2, 0, -1});
    for (Vec3f& p : wall.positions)
        if (p.y == 0) p.y = -1;
    return tiles({tile(0, 0, 2, 4), tile(2, 0, 2, 4), wall}, {{8, 0}, {8, 0}, {0.5, 0}});
}

TEST(SeamJoin, WhereAWallStandsTheLightStaysApart) {
    for (const float thickness : {0.01f, 0.1f, 0.2f, 0.4f}) {
        const SeamScene s = floor_with_wall(thickness);
        const SeamSamples samples = s.samples();
        EXPECT_TRUE(samples.samples.empty()) << thickness;
        EXPECT_GT(samples.blocked + samples.hidden, 30u);
        LitPages pages =
            paint(s, [](const Vec3f&, std::uint32_t object) { return Rgb(1, 1, 1) * (object ? 100.0f : 1.0f); });
        const LitPages before = pages;
        join(samples, pages);
        EXPECT_EQ(pages.values, before.values);
    }
}

TEST(SeamJoin, StaysBetweenWhatItReads) {
    // Black against bright, on crossed grids: least squares alone would go below zero.
    const SeamScene s = tiles({tile(0, 0, 2, 4), tile(2, 0, 2, 4)}, {{8, 0.7}, {3, -0.3}});
    LitPages pages = paint(s, [](const Vec3f& at, std::uint32_t object) {
        return Rgb(object && std::fmod(at.z, 0.9f) > 0.4f ? 1e4f : 0.0f, object ? 1e-30f : 1e30f,
                   at.z > 2 ? 5.0f : 0.0f);
    });
    const LitPages before = pages;
    const SeamJump jump = join(s.samples(), pages);
    EXPECT_LT(jump.after, jump.before);
    for (std::size_t t = 0; t < pages.values[0].size(); ++t)
        for (int c = 0; c < 3; ++c) {
            EXPECT_TRUE(std::isfinite(pages.values[0][t][c]) && pages.values[0][t][c] >= 0);
            EXPECT_LE(pages.values[0][t][c], c == 0 ? 1e4f : c == 1 ? 1e30f : 5.0f);
        }
    EXPECT_NE(pages.values, before.values);
}

TEST(SeamJoin, EvenLightKeepsEveryBit) {
    const SeamScene s = cut_square();
    LitPages pages = paint(s, [](const Vec3f&, std::uint32_t) { return Rgb(0.3f, 1234.5f, 0); });
    // Means of texels round differently; even is what all texels have.
    for (std::size_t t = 0; t < pages.values[0].size(); ++t)
        if (pages.masks[0][t]) pages.values[0][t] = Rgb(0.3f, 1234.5f, 0);
    const LitPages before = pages;
    EXPECT_EQ(join(s.samples(), pages).texels, 0u);
    EXPECT_EQ(pages.values, before.values);
}

TEST(SeamJoin, ChartsTooCloseAreLeftAlone) {
    // Without padding the filter of one reads the other's texels, which are not the seam's to change.
    SeamScene s = tiles({tile(0, 0, 2, 4), tile(9, 0, 2, 4), tile(11, 0, 2, 4)}, {{8, 0}, {8, 0}, {8, 0}}, 0);
    for (Chart& chart : s.atlas.charts) chart.width = 16;
    s.atlas.charts[1].x = 16, s.atlas.charts[2].x = 40;
    s.texels = raster_texels(s.scene, s.atlas);
    EXPECT_EQ(s.samples().crowded, 0u) << "the seam is on the far side of chart 1";
    s.atlas.charts[1].x = 40, s.atlas.charts[2].x = 56;
    s.texels = raster_texels(s.scene, s.atlas);
    const SeamSamples samples = s.samples();
    EXPECT_TRUE(samples.samples.empty());
    EXPECT_GT(samples.crowded, 50u);
}

TEST(SeamJoin, PointsOnTexelsWithoutAValueAreLeftOut) {
    const SeamScene s = cut_square();
    const SeamSamples samples = s.samples();
    std::vector<SeamTexelKind> kinds(samples.texels.size(), SeamTexelKind::empty);
    std::vector<Rgb> values(samples.texels.size(), Rgb(1, 2, 3));
    const SeamJump jump = join_seams(samples, kinds, values);
    EXPECT_EQ(jump.length_texels, 0);
    EXPECT_EQ(values, std::vector<Rgb>(samples.texels.size(), Rgb(1, 2, 3)));
    EXPECT_THROW(join_seams(samples, std::span(kinds).first(1), values), Error);
}

TEST(SeamJoin, TheSameBytesForAnyNumberOfThreads) {
    const SeamScene s =
        tiles({tile(0, 0, 1, 2), tile(1, 0, 1, 2), tile(0, 2, 2, 2), tile(5, 0, 1, 2), tile(6, 0, 1, 2)},
              {{8, 0.2}, {5, -0.5}, {7, 1}, {4, 0.1}, {9, 0.8}});
    const auto joined = [&](unsigned threads) {
        const ThreadLimit limit(threads);
        LitPages pages = paint(s, [](const Vec3f& at, std::uint32_t) { return gradient(at); });
        join(s.samples(), pages);
        return pages.values;
    };
    const auto one = joined(1);
    EXPECT_EQ(one, joined(2));
    EXPECT_EQ(one, joined(7));
}

TEST(SeamJoin, TheMemoryBoundHolds) {
    const SeamScene s = tiles({tile(0, 0, 1, 2), tile(1, 0, 1, 2), tile(0, 2, 2, 2)}, {{8, 0.2}, {5, -0.5}, {7, 1}});
    const std::vector<Seam> seams = s.seams();
    const SeamSamples samples = s.samples();
    EXPECT_EQ(seam_point_count(seams), samples.samples.size());
    std::uint64_t texels = 0;
    for (const Seam& seam : seams) texels += 5 + 3 * seam_point_count({&seam, 1});
    EXPECT_LE(samples.texels.size(), texels);
    EXPECT_GE(seam_join_bytes(seams),
              samples.samples.size() * sizeof(SeamSample) + samples.texels.size() * sizeof(SeamTexel));
}

}  // namespace
}  // namespace luxel::test
