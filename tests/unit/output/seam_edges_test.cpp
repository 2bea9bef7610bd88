// Seams are where borders of charts meet on smooth surface, and nowhere else.
#include "baker/output/seam_edges.h"

#include <gtest/gtest.h>

#include "baker/core/parallel.h"
#include "tests/unit/output/seam_scene.h"

namespace luxel::test {
namespace {

double length_m(const SeamScene& s, const Seam& seam) {
    return (position_at(s, seam.a.triangle, seam.a.to) - position_at(s, seam.a.triangle, seam.a.from)).length();
}
double total_m(const SeamScene& s, const std::vector<Seam>& seams) {
    double sum = 0;
    for (const Seam& seam : seams) sum += length_m(s, seam);
    return sum;
}
/// Both sides of every seam are the same points in space.
void expect_sides_agree(const SeamScene& s, const std::vector<Seam>& seams) {
    for (const Seam& seam : seams) {
        EXPECT_LT(
            (position_at(s, seam.a.triangle, seam.a.from) - position_at(s, seam.b.triangle, seam.b.from)).length(),
            1e-4);
        EXPECT_LT((position_at(s, seam.a.triangle, seam.a.to) - position_at(s, seam.b.triangle, seam.b.to)).length(),
                  1e-4);
    }
}

SeamScene flat(const std::vector<MadeMesh>& meshes, const std::vector<FlatLayout>& layouts) {
    SceneMaker maker;
    for (std::size_t m = 0; m < meshes.size(); ++m) maker.add("tile" + std::to_string(m), meshes[m]);
    Scene scene = maker.build();
    Atlas atlas = flat_atlas(scene, layouts);
    return {std::move(scene), std::move(atlas)};
}

TEST(SeamEdges, TwoTilesOfDifferentObjects) {
    const SeamScene s = flat({tile(0, 0, 1, 2), tile(1, 0, 1.5f, 2)}, {{8, 0}, {5, 0.4}});
    const auto seams = s.seams();
    ASSERT_EQ(seams.size(), 1u);
    EXPECT_NEAR(length_m(s, seams[0]), 2, 1e-5);
    expect_sides_agree(s, seams);
}

TEST(SeamEdges, InsideAChartThereIsNone) { EXPECT_TRUE(flat({tile(0, 0, 1, 2)}, {{8, 0.3}}).seams().empty()); }

TEST(SeamEdges, PartsOfALongerEdgeAndTilesSetOff) {
    // A floor of 3 m against tiles of 0.7, 1.1 and 1.2 m, the last of which reaches 0.5 m beyond it.
    const SeamScene s = flat({tile(0, 0, 1, 3), tile(1, 0, 1, 0.7f), tile(1, 0.7f, 1, 1.1f), tile(1, 1.8f, 1, 1.7f)},
                             {{6, 0}, {6, 0.1}, {6, 0.2}, {6, 0.3}});
    const auto seams = s.seams();
    EXPECT_EQ(seams.size(), 5u) << "three with the floor, two among the tiles";
    EXPECT_NEAR(total_m(s, seams), 3 + 2, 1e-4);
    expect_sides_agree(s, seams);
}

TEST(SeamEdges, WithinRoundingIsTogetherAndMoreIsNot) {
    EXPECT_EQ(flat({tile(0, 0, 1, 2), tile(std::nextafter(1.0f, 2.0f), 0, 1, 2)}, {{8, 0}, {8, 0}}).seams().size(), 1u);
    EXPECT_TRUE(flat({tile(0, 0, 1, 2), tile(1.001f, 0, 1, 2)}, {{8, 0}, {8, 0}}).seams().empty());
    EXPECT_TRUE(flat({tile(0, 0, 1, 2), tile(1, 0, 1, 2, 0.001f)}, {{8, 0}, {8, 0}}).seams().empty());
}

TEST(SeamEdges, TilesOnTopOfEachOtherAreNone) {
    EXPECT_TRUE(flat({tile(0, 0, 1, 2), tile(0, 0, 1, 2), tile(0, 0, 1, 2)}, {{8, 0}, {8, 0}, {8, 0}}).seams().empty());
    // Back to back: the edges run against each other, but the fronts look away from each other.
    EXPECT_TRUE(flat({tile(0, 0, 1, 2), turned(tile(0, 0, 1, 2))}, {{8, 0}, {8, 0}}).seams().empty());
}

TEST(SeamEdges, AHardCreaseIsNone) {
    EXPECT_TRUE(unwrapped(box(1, 2, 3)).seams().empty());
    EXPECT_TRUE(unwrapped(room({0, 0, 0}, {3, 2, 4})).seams().empty());
}

TEST(SeamEdges, RoundedNormalsDoNotMakeARimSmooth) {
    // Two sheets back to back whose normals at the common rim are the same.
    MadeMesh mesh = tile(0, 0, 1, 2);
    append(mesh, turned(tile(0, 0, 1, 2)));
    const std::vector<Vec3f> normals(mesh.positions.size(), Vec3f(1, 0, 0));
    EXPECT_TRUE(unwrapped(mesh, normals).seams().empty());
}

TEST(SeamEdges, AllBordersOfASmoothClosedSurfaceAreSeams) {
    const MadeMesh ball = icosphere(3, 1);
    const SeamScene s = unwrapped(ball, ball.positions);
    ASSERT_GT(s.atlas.charts.size(), 1u);
    const auto seams = s.seams();
    // Each edge of the mesh is inside a chart or a seam: counted by positions, without the finder.
    std::map<std::array<float, 6>, std::vector<std::pair<std::uint32_t, int>>> edges;
    for (std::uint32_t t = 0; t < s.scene.triangle_count(); ++t)
        for (int k = 0; k < 3; ++k) {
            const Vec3f &p = s.scene.corner(t, k), &q = s.scene.corner(t, (k + 1) % 3);
            std::array<float, 6> one{p.x, p.y, p.z, q.x, q.y, q.z}, other{q.x, q.y, q.z, p.x, p.y, p.z};
            edges[std::min(one, other)].emplace_back(t, k);
        }
    std::size_t cut = 0;
    for (const auto& [ends, sides] : edges) {
        ASSERT_EQ(sides.size(), 2u);
        cut += s.atlas.triangle_chart[sides[0].first] != s.atlas.triangle_chart[sides[1].first] ||
               (s.atlas.page_uv(sides[0].first, sides[0].second) -
                s.atlas.page_uv(sides[1].first, (sides[1].second + 1) % 3))
                       .length() > 0.1f;
    }
    EXPECT_GT(cut, 20u);
    EXPECT_EQ(seams.size(), cut);
    expect_sides_agree(s, seams);
}

TEST(SeamEdges, ATubeThatIsCutOpenMeetsItself) {
    // Eight smooth quads around, one chart: only the cut is a seam.
    MadeMesh tube;
    std::vector<Vec3f> normals;
    constexpr int around = 16;
    for (int k = 0; k <= around; ++k)
        for (const float y : {0.0f, 1.0f}) {
            const float turn = 6.28318531f * static_cast<float>(k % around) / around;
            tube.positions.emplace_back(std::cos(turn), y, std::sin(turn));
            normals.emplace_back(std::cos(turn), 0.0f, std::sin(turn));
        }
    for (std::uint32_t k = 0; k < around; ++k) {
        tube.triangles.push_back({2 * k, 2 * k + 1, 2 * k + 2});
        tube.triangles.push_back({2 * k + 1, 2 * k + 3, 2 * k + 2});
    }
    SceneMaker maker;
    maker.add("tube", tube);
    maker.record().meshes[0].primitives[0].normals = normals;
    Scene scene = maker.build();
    ASSERT_EQ(scene.triangle_count(), tube.triangles.size());
    Atlas atlas = flat_atlas(scene, {{4, 0}});
    for (std::uint32_t t = 0; t < scene.triangle_count(); ++t)
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t v = tube.triangles[t][k];
            atlas.corner_uv[3 * t + k] = {static_cast<float>(v / 2) * 2, static_cast<float>(v % 2) * 5};
        }
    atlas.charts[0].width = 2 * around + 1;
    atlas.charts[0].height = 6;
    const auto seams = find_seams(scene, atlas);
    ASSERT_EQ(seams.size(), 1u);
    EXPECT_NEAR(std::abs(seams[0].a.from.x - seams[0].b.from.x), 2 * around, 1e-4);
    EXPECT_FLOAT_EQ(seams[0].a.from.y, seams[0].b.from.y);
}

TEST(SeamEdges, HostileCrowdsStayCheap) {
    // Thousands of tiles in one place, and a needle fan of others whose edges all begin in one point.
    SceneMaker maker;
    MadeMesh crowd;
    for (int k = 0; k < 4000; ++k) {
        append(crowd, tile(0, 0, 1, 1));
        append(crowd, tile(1, 0, 1, 1));
        const float turn = static_cast<float>(k) * 1e-3f;
        append(crowd, quad({0, 0, 0}, {std::sin(turn), 0, std::cos(turn)},
                           {1e-3f * std::cos(turn), 0, -1e-3f * std::sin(turn)}));
    }
    maker.add("crowd", crowd);
    const Scene scene = maker.build();
    Atlas atlas = flat_atlas(scene, {{8, 0}});
    // No two triangles share an edge on the page: all edges are borders, and many places have no area.
    for (std::size_t c = 0; c < atlas.corner_uv.size(); ++c)
        atlas.corner_uv[c] = {static_cast<float>(c / 3), static_cast<float>(c % 3)};
    const auto seams = find_seams(scene, atlas);
    EXPECT_FALSE(seams.empty());
    EXPECT_LE(seams.size(), 3 * scene.triangle_count() * seam_limits::most_partners);
}

TEST(SeamEdges, TheSameForAnyNumberOfThreads) {
    const MadeMesh ball = icosphere(4, 1);
    const SeamScene s = unwrapped(ball, ball.positions);
    const auto found = [&](unsigned threads) {
        const ThreadLimit limit(threads);
        std::vector<std::array<float, 10>> all;
        for (const Seam& seam : s.seams())
            all.push_back({static_cast<float>(seam.a.triangle), static_cast<float>(seam.b.triangle), seam.a.from.x,
                           seam.a.from.y, seam.a.to.x, seam.a.to.y, seam.b.from.x, seam.b.from.y, seam.b.to.x,
                           seam.b.to.y});
        return all;
    };
    const auto one = found(1);
    EXPECT_GT(one.size(), 50u);
    EXPECT_EQ(one, found(4));
}

TEST(SeamEdges, NothingInAnEmptyScene) { EXPECT_TRUE(find_seams(Scene(), Atlas()).empty()); }

}  // namespace
}  // namespace luxel::test
