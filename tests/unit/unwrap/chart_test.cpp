// The parts of unwrapping one by one: pieces, fallback charts, overlap check, fit, packing.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "baker/unwrap/fit_page.h"
#include "baker/unwrap/pack.h"
#include "baker/unwrap/pieces.h"
#include "baker/unwrap/planar_charts.h"
#include "formats/base/error.h"
#include "tests/unit/unwrap/made_scene.h"

namespace luxel {
namespace {

ObjectMesh mesh_of(const test::MadeMesh& made) {
    Scene scene;
    test::add_object(scene, "mesh", made, 1);
    return object_mesh(scene, scene.objects[0]);
}

std::vector<std::uint32_t> all_triangles(const ObjectMesh& mesh) {
    std::vector<std::uint32_t> all(mesh.triangles.size());
    std::iota(all.begin(), all.end(), 0u);
    return all;
}

TEST(ObjectMesh, WeldsEqualPositions) {
    test::MadeMesh made = test::box(1, 2, 3);
    const auto corners = made.positions;
    made.positions.insert(made.positions.end(), corners.begin(), corners.end());
    for (std::size_t t = 0; t < 6; ++t)
        for (auto& v : made.triangles[t]) v += 8;
    const ObjectMesh mesh = mesh_of(made);
    EXPECT_EQ(mesh.positions.size(), 8u);
    double area = 0;
    for (const std::uint32_t t : all_triangles(mesh)) area += mesh.area_m2(t);
    EXPECT_NEAR(area, 22, 1e-9);
}

TEST(Pieces, AreBoundedAndComplete) {
    const ObjectMesh mesh = mesh_of(test::terrain(50, 0.1f, 0.4f));
    for (const std::size_t limit : {1u, 7u, 500u, 100000u}) {
        std::vector<std::uint32_t> together;
        for (const auto& piece : cut_pieces(mesh, limit)) {
            EXPECT_LE(piece.size(), limit);
            EXPECT_TRUE(std::is_sorted(piece.begin(), piece.end()));
            together.insert(together.end(), piece.begin(), piece.end());
        }
        std::sort(together.begin(), together.end());
        EXPECT_EQ(together, all_triangles(mesh));
    }
}

TEST(PlanarCharts, AreValidAndComplete) {
    for (const auto& made : {test::box(1, 2, 3), test::sphere(16, 1), test::terrain(20, 0.1f, 4.0f)}) {
        const ObjectMesh mesh = mesh_of(made);
        std::vector<std::uint32_t> together;
        for (const FlatChart& chart : planar_charts(mesh, all_triangles(mesh), 100)) {
            EXPECT_TRUE(is_valid(mesh, chart, 100));
            together.insert(together.end(), chart.triangles.begin(), chart.triangles.end());
        }
        std::sort(together.begin(), together.end());
        EXPECT_EQ(together, all_triangles(mesh));
    }
}

TEST(ChartShape, FindsOverlaps) {
    const ObjectMesh mesh = mesh_of(test::terrain(10, 0.1f, 0));
    FlatChart chart = project_chart(mesh, all_triangles(mesh));
    restore_scale(mesh, chart);
    orient(chart);
    EXPECT_TRUE(is_valid(mesh, chart, 200));
    EXPECT_EQ(sample_coverage(chart, 200).overlapped, 0u);
    FlatChart folded = chart;
    folded.corner_uv[20] = folded.corner_uv[21];
    EXPECT_FALSE(is_valid(mesh, folded, 200));
    FlatChart turned = chart;
    std::swap(turned.corner_uv[20][0], turned.corner_uv[20][1]);
    EXPECT_FALSE(is_valid(mesh, turned, 200));
}

TEST(ChartShape, UndoesStretchAndTurn) {
    const ObjectMesh mesh = mesh_of(test::terrain(10, 0.1f, 0.2f));
    FlatChart plain = project_chart(mesh, all_triangles(mesh));
    FlatChart stretched = plain;
    for (auto& uv : stretched.corner_uv)
        for (Vec2d& p : uv) p = {-7 * p.x, 0.3 * p.y};
    for (FlatChart* chart : {&plain, &stretched}) {
        restore_scale(mesh, *chart);
        orient(*chart);
        EXPECT_TRUE(is_valid(mesh, *chart, 100));
    }
    EXPECT_NEAR(extent_of(plain).x, extent_of(stretched).x, 1e-6);
    EXPECT_NEAR(extent_of(plain).y, extent_of(stretched).y, 1e-6);
    EXPECT_GE(extent_of(plain).x, extent_of(plain).y * (1 - 1e-5));
}

TEST(FitPage, SplitsUntilItFits) {
    const ObjectMesh mesh = mesh_of(test::terrain(30, 0.1f, 0));
    FlatChart chart = project_chart(mesh, all_triangles(mesh));
    restore_scale(mesh, chart);
    orient(chart);
    std::vector<TexelChart> out;
    EXPECT_FALSE(fit_chart(mesh, chart, 100, 60, out));
    std::size_t triangles = 0;
    for (const TexelChart& part : out) {
        EXPECT_LE(std::max(part.width, part.height), 60u);
        triangles += part.triangles.size();
    }
    EXPECT_EQ(triangles, mesh.triangles.size());
    EXPECT_GT(out.size(), 20u);
    out.clear();
    EXPECT_TRUE(fit_chart_whole(chart, 100, 60, out));
    EXPECT_EQ(out.size(), 1u);
    EXPECT_LE(out[0].width, 60u);
}

TEST(FitPage, CutsHollowCharts) {
    test::MadeMesh frame;  // four bars around an empty square
    frame.positions = {{0, 0, 0},       {10, 0, 0},      {10, 8, 0},      {0, 8, 0},
                       {0.1f, 0.1f, 0}, {9.9f, 0.1f, 0}, {9.9f, 7.9f, 0}, {0.1f, 7.9f, 0}};
    for (std::uint32_t i = 0; i < 4; ++i) {
        const std::uint32_t j = (i + 1) % 4;
        frame.triangles.push_back({i, j, j + 4});
        frame.triangles.push_back({i, j + 4, i + 4});
    }
    const ObjectMesh mesh = mesh_of(frame);
    FlatChart chart = project_chart(mesh, all_triangles(mesh));
    restore_scale(mesh, chart);
    orient(chart);
    std::vector<TexelChart> fine, coarse;
    EXPECT_FALSE(fit_chart(mesh, chart, 20, 1000, fine));
    std::size_t texels = 0, triangles = 0;
    for (const TexelChart& part : fine) {
        texels += std::size_t{part.width} * part.height;
        triangles += part.triangles.size();
    }
    EXPECT_EQ(triangles, 8u);
    EXPECT_LT(texels, 200u * 160u / 4);
    EXPECT_FALSE(fit_chart(mesh, chart, 1, 1000, coarse));
    EXPECT_EQ(coarse.size(), 1u) << "too small to be worth a cut";
}

TEST(Pack, FillsPagesWithoutOverlap) {
    std::vector<PackedRectangle> charts(5000);
    std::uint64_t area = 0;
    for (std::size_t i = 0; i < charts.size(); ++i) {
        charts[i].width = 1 + static_cast<std::uint32_t>(mix(i, 1) % 40);
        charts[i].height = 1 + static_cast<std::uint32_t>(mix(i, 2) % 20);
        area += std::uint64_t{charts[i].width + 3} * (charts[i].height + 3);
    }
    const std::uint32_t pages = pack_pages(charts, 512, 3);
    EXPECT_LE(pages, 1.25 * static_cast<double>(area) / (512.0 * 512) + 1);
    std::vector<std::vector<bool>> taken(pages, std::vector<bool>(512 * 512, false));
    for (const PackedRectangle& chart : charts)
        for (std::uint32_t y = chart.y - 3; y < chart.y + chart.height; ++y)
            for (std::uint32_t x = chart.x - 3; x < chart.x + chart.width; ++x) {
                ASSERT_FALSE(taken[chart.page][y * 512 + x]);
                taken[chart.page][y * 512 + x] = true;
            }
    charts[0].width = 507;
    EXPECT_THROW(pack_pages(charts, 512, 3), Error);
}

}  // namespace
}  // namespace luxel
