/// Cells never hold both sides of a wall; counts are the same from both ends and depend on stable ids alone.
#include "baker/chunks/sight_graph.h"

#include <gtest/gtest.h>

#include <map>

#include "baker/core/parallel.h"
#include "tests/support/scenes.h"

namespace luxel {
namespace {

using test::Prepared;
using test::SceneMaker;

std::unique_ptr<Prepared> furnished(std::uint32_t chunk_patches = 256) {
    SceneMaker maker;
    return test::prepare(maker.add("walls", test::room({0, 0, 0}, {4, 3, 4}))
                             .add("ball", test::moved(test::icosphere(2, 0.5f), {2, 1, 2}))
                             .add("board", test::moved(test::box(1, 1, 0.02f), {1, 1, 1}))
                             .build(),
                         {.chunk_patches = chunk_patches});
}

SightGraph sight_of(const Prepared& made, const SightCells& cells, std::uint32_t rays = 8) {
    return trace_sight(made.scene, made.atlas, made.patches, *made.tracer, cells, rays);
}

TEST(SightCells, HoldOneSideWithinOneCube) {
    const auto made = furnished();
    for (const double edge_m : {0.5, 2.0, 8.0}) {
        const SightCells cells = find_sight_cells(made->patches, edge_m);
        std::vector<bool> met(made->patches.count(), false);
        PatchId before = 0;
        for (std::size_t c = 0; c < cells.count(); ++c) {
            ASSERT_FALSE(cells.patches[c].empty());
            const Patch& first = made->patches.patches[cells.patches[c].front()];
            PatchId least = first.id;
            for (const PatchNumber p : cells.patches[c]) {
                const Patch& patch = made->patches.patches[p];
                EXPECT_FALSE(met[p]);
                met[p] = true;
                EXPECT_EQ(cells.cell_of[p], c);
                EXPECT_EQ(patch.chart, first.chart);
                EXPECT_GT(patch.normal.dot(first.normal), -0.34f)
                    << "normals that are nearest to one axis are 110 degrees apart at most";
                for (int k = 0; k < 3; ++k)
                    EXPECT_LE(std::fabs(static_cast<double>(patch.center[k]) - cells.middle[c][k]), edge_m / 2);
                least = std::min(least, patch.id);
            }
            EXPECT_GT(least, before) << "in the order of their smallest ids";
            before = least;
        }
        EXPECT_EQ(std::count(met.begin(), met.end(), false), 0);
    }
}

TEST(SightGraph, IsSymmetricAndCountsEveryRay) {
    const auto made = furnished();
    const SightCells cells = find_sight_cells(made->patches, 1.0);
    const SightGraph graph = sight_of(*made, cells);
    ASSERT_EQ(graph.count(), cells.count());
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint64_t> rays;
    std::uint64_t sum = 0;
    for (std::uint32_t n = 0; n < graph.count(); ++n) {
        EXPECT_EQ(graph.patches[n], cells.patches[n].size());
        for (const SightGraph::Link& link : graph.links_of(n)) {
            EXPECT_NE(link.other, n);
            EXPECT_GT(link.rays, 0u);
            EXPECT_TRUE((rays.insert({{n, link.other}, link.rays}).second)) << "every other node once";
            sum += link.rays;
        }
    }
    for (const auto& [pair, count] : rays) EXPECT_EQ(rays.at({pair.second, pair.first}), count);
    // A closed room: rays land, and few in the cell that they come from.
    const std::uint64_t all = 8 * made->patches.count();
    EXPECT_LE(sum / 2, all);
    EXPECT_GT(sum / 2, all * 9 / 10);
}

TEST(SightGraph, DependsOnIdsAlone) {
    const auto made = furnished(), other = furnished(16);
    EXPECT_NE(made->ids(), other->ids());
    const SightCells cells = find_sight_cells(made->patches, 1.0), other_cells = find_sight_cells(other->patches, 1.0);
    const auto same = [](const SightGraph& a, const SightGraph& b) {
        return a.row_begin == b.row_begin && a.patches == b.patches &&
               std::equal(a.links.begin(), a.links.end(), b.links.begin(), b.links.end(),
                          [](const auto& x, const auto& y) { return x.other == y.other && x.rays == y.rays; });
    };
    const SightGraph graph = sight_of(*made, cells);
    EXPECT_TRUE(same(graph, sight_of(*other, other_cells)));
    const ThreadLimit one(1);
    EXPECT_TRUE(same(graph, sight_of(*made, cells)));
    EXPECT_FALSE(same(graph, sight_of(*made, cells, 16)));
}

TEST(SightGraph, JoinedNodesAddUp) {
    SightGraph graph;  // 0 - 1: 5, 1 - 2: 7, 0 - 3: 2, 2 - 3: 1
    graph.patches = {1, 2, 3, 4};
    graph.links = {{1, 5}, {3, 2}, {0, 5}, {2, 7}, {1, 7}, {3, 1}, {0, 2}, {2, 1}};
    graph.row_begin = {0, 2, 4, 6, 8};
    const SightGraph joined = join_nodes(graph, std::vector<std::uint32_t>{0, 0, 1, 1}, 2);
    EXPECT_EQ(joined.patches, (std::vector<std::uint32_t>{3, 7}));
    ASSERT_EQ(joined.links.size(), 2u);
    EXPECT_EQ(joined.links[0].other, 1u);
    EXPECT_EQ(joined.links[0].rays, 9u);
    EXPECT_EQ(joined.links[1].other, 0u);
    EXPECT_EQ(joined.links[1].rays, 9u);
}

}  // namespace
}  // namespace luxel
