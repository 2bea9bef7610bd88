/// Links between the cells of a chart: all of a plain one, none through walls, and what is seen from a patch.
#include "baker/light/cell_links.h"

#include <gtest/gtest.h>

#include <map>

#include "tests/support/scenes.h"

namespace luxel {
namespace {

using test::Prepared;
using test::quad;
using test::SceneMaker;

constexpr std::uint32_t cell = 4;

std::unique_ptr<Prepared> floor_with(const test::MadeMesh* wall) {
    SceneMaker maker;
    maker.add("floor", quad({0, 0, 0}, {0, 0, 4}, {4, 0, 0}));
    if (wall) maker.add("wall", *wall);
    return test::prepare(maker.build(), {.texels_per_metre = 8, .patch_texels = cell});
}

/// Cell of the floor's chart -> the patch that holds most of it.
std::map<std::pair<int, int>, PatchNumber> floor_cells(const Prepared& made) {
    std::map<std::pair<int, int>, PatchNumber> cells;
    for (PatchNumber p = 0; p < made.patches.count(); ++p) {
        const Patch& patch = made.patches.patches[p];
        const Chart& chart = made.atlas.charts[patch.chart];
        if (chart.object != 0 || patch.is_back) continue;
        const Fragment& first = made.patches.fragments_of(p).front();
        const auto [at, is_new] = cells.try_emplace({(first.x - static_cast<int>(chart.x)) / static_cast<int>(cell),
                                                     (first.y - static_cast<int>(chart.y)) / static_cast<int>(cell)},
                                                    p);
        if (!is_new && made.patches.patches[at->second].area_m2 < patch.area_m2) at->second = p;
    }
    return cells;
}

std::vector<CellLinks> links_of(const Prepared& made) {
    return link_cells(made.atlas, made.texels.pages[0], made.patches, 0, cell);
}

TEST(CellLinks, APlainChartIsAGrid) {
    const auto made = floor_with(nullptr);
    const auto cells = floor_cells(*made);
    const auto at = [&](int x, int y) { return cells.contains({x, y}) ? cells.at({x, y}) : no_patch; };
    const auto links = links_of(*made);
    ASSERT_EQ(links.size(), made->patches.count());
    ASSERT_GE(cells.size(), 64u);
    for (const auto& [place, patch] : cells) {
        const auto [x, y] = place;
        EXPECT_EQ(links[patch].left, at(x - 1, y));
        EXPECT_EQ(links[patch].right, at(x + 1, y));
        EXPECT_EQ(links[patch].up, at(x, y - 1));
        EXPECT_EQ(links[patch].down, at(x, y + 1));
        const CellWindow window(links, patch, 2);
        for (int dy = -2; dy <= 2; ++dy)
            for (int dx = -2; dx <= 2; ++dx) EXPECT_EQ(window.at(dx, dy), at(x + dx, y + dy));
        const CellWindow near(links, patch, 1);
        EXPECT_EQ(near.at(1, 1), at(x + 1, y + 1));
        EXPECT_EQ(near.at(2, 0), no_patch);
    }
}

TEST(CellLinks, AWallPartsAndItsEndDoesNot) {
    // From z = 0 to 2 at x = 2.
    test::MadeMesh wall = quad({2, 0, 0}, {0, 1, 0}, {0, 0, 2});
    test::append(wall, quad({2, 0, 0}, {0, 0, 2}, {0, 1, 0}));
    const auto made = floor_with(&wall);
    const auto links = links_of(*made);
    std::size_t parted = 0, joined = 0;
    for (PatchNumber p = 0; p < made->patches.count(); ++p) {
        if (made->atlas.charts[made->patches.patches[p].chart].object != 0) continue;
        for (const PatchNumber q : {links[p].left, links[p].right, links[p].up, links[p].down}) {
            const auto x = [&](PatchNumber patch) {
                return made->patches.patches[patch].center.x + static_cast<float>(made->scene.origin.x);
            };
            const auto z = [&](PatchNumber patch) {
                return made->patches.patches[patch].center.z + static_cast<float>(made->scene.origin.z);
            };
            if (q == no_patch || (x(p) < 2) == (x(q) < 2)) continue;
            (z(p) < 2 ? parted : joined) += 1;
        }
    }
    EXPECT_EQ(parted, 0u);
    EXPECT_EQ(joined, 8u) << "four pairs beyond its end, seen from both sides";
    // From beside the wall the way around its end is a detour: the cell on its other side is not seen.
    for (PatchNumber p = 0; p < made->patches.count(); ++p) {
        const Patch& patch = made->patches.patches[p];
        const float x = patch.center.x + static_cast<float>(made->scene.origin.x),
                    z = patch.center.z + static_cast<float>(made->scene.origin.z);
        if (made->atlas.charts[patch.chart].object != 0 || z > 1 || x > 2 || x < 1.5f) continue;
        const CellWindow window(links, p, 2);
        for (int dy = -2; dy <= 2; ++dy)
            for (int dx = -2; dx <= 2; ++dx)
                if (window.at(dx, dy) != no_patch) {
                    EXPECT_LT(
                        made->patches.patches[window.at(dx, dy)].center.x + static_cast<float>(made->scene.origin.x),
                        2);
                }
    }
}

TEST(CellLinks, NoneThroughASolid) {
    const test::MadeMesh wall = test::moved(test::box(0.2f, 1, 4), {1.9f, 0, 0});
    const auto made = floor_with(&wall);
    const auto links = links_of(*made);
    for (PatchNumber p = 0; p < made->patches.count(); ++p) {
        if (made->atlas.charts[made->patches.patches[p].chart].object != 0) continue;
        for (const PatchNumber q : {links[p].left, links[p].right, links[p].up, links[p].down}) {
            if (q == no_patch) continue;
            const auto is_left = [&](PatchNumber patch) {
                return made->patches.patches[patch].center.x + static_cast<float>(made->scene.origin.x) < 2;
            };
            EXPECT_EQ(is_left(p), is_left(q));
        }
    }
}

}  // namespace
}  // namespace luxel
