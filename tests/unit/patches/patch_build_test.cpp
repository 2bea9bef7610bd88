// Patches: a partition of the texels, exact area and power, names that survive changes elsewhere.
#include "baker/patches/patch_build.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "baker/core/parallel.h"
#include "baker/patches/fragment_polygon.h"
#include "baker/patches/patch_lookup.h"
#include "formats/base/error.h"
#include "tests/unit/patches/made_patches.h"

namespace luxel {
namespace {

using test::MadePatches;
using test::make_patches;

TEST(PatchBuild, IsAPartitionOfTheTexels) {
    for (const std::uint32_t k : {1u, 3u, 4u, 64u}) {
        const MadePatches made = make_patches(test::coloured_scene(), 23, k);
        std::vector<double> area(made.set.count(), 0);
        for (std::size_t page = 0; page < made.texels.pages.size(); ++page) {
            std::size_t covered = 0;
            for (const Texel& texel : made.texels.pages[page].texels) {
                const PatchNumber p = made.set.page_patch[page][texel.y * 256u + texel.x];
                ASSERT_LT(p, made.set.count());
                EXPECT_EQ(made.set.patches[p].chart, texel.chart);
                area[p] += texel.area_m2;
            }
            for (const PatchNumber p : made.set.page_patch[page]) covered += p != no_patch;
            EXPECT_EQ(covered, made.texels.pages[page].texels.size());
        }
        std::size_t fragments = 0;
        for (PatchNumber p = 0; p < made.set.count(); ++p) {
            EXPECT_NEAR(made.set.patches[p].area_m2, area[p], 1e-6 * area[p]);
            double sum = 0;
            for (const Fragment& f : made.set.fragments_of(p)) sum += f.area_m2;
            EXPECT_NEAR(sum, area[p], 1e-6 * area[p]);
            fragments += made.set.fragments_of(p).size();
            EXPECT_NEAR(made.set.patches[p].normal.length(), 1, 1e-5);
        }
        EXPECT_EQ(fragments, made.set.fragments.size());
    }
}

TEST(PatchBuild, PowerIsExact) {
    const MadePatches made = make_patches(test::coloured_scene());
    Vec3d from_patches(0), from_texels(0), from_surface(0);
    double absorbed_patches = 0, absorbed_texels = 0;
    for (const Patch& patch : made.set.patches) {
        from_patches += to_double(patch.emission) * double{patch.area_m2};
        absorbed_patches += double{patch.area_m2} * (1 - double{patch.reflectance.x});
    }
    for (const PageTexels& page : made.texels.pages)
        for (const Texel& texel : page.texels) {
            from_texels += to_double(texel.emission) * double{texel.area_m2};
            absorbed_texels += double{texel.area_m2} * (1 - double{texel.reflectance.x});
        }
    for (std::uint32_t t = 0; t < made.scene.triangle_count(); ++t)
        from_surface += to_double(made.scene.material_of(t).emission) * made.scene.area_m2(t);
    for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(from_patches[c], from_texels[c], 1e-7 * from_texels[c]);
        EXPECT_NEAR(from_patches[c], from_surface[c], 1e-6 * from_surface[c]);
    }
    EXPECT_NEAR(absorbed_patches, absorbed_texels, 1e-6 * absorbed_texels);
}

TEST(PatchBuild, SetsHangTogether) {
    const MadePatches made = make_patches(test::coloured_scene(), 23, 8);
    std::map<PatchNumber, std::set<std::pair<int, int>>> texels;
    for (std::size_t page = 0; page < made.texels.pages.size(); ++page)
        for (const Texel& texel : made.texels.pages[page].texels)
            texels[made.set.page_patch[page][texel.y * 256u + texel.x]].insert({texel.x, texel.y});
    for (const auto& [patch, squares] : texels) {
        std::set<std::pair<int, int>> reached{*squares.begin()};
        std::vector<std::pair<int, int>> queue{*squares.begin()};
        while (!queue.empty()) {
            const auto [x, y] = queue.back();
            queue.pop_back();
            for (const auto& next : {std::pair{x + 1, y}, {x - 1, y}, {x, y + 1}, {x, y - 1}})
                if (squares.count(next) && reached.insert(next).second) queue.push_back(next);
        }
        EXPECT_EQ(reached.size(), squares.size());
        // Inside one cell of the chart's own grid.
        const Chart& chart = made.atlas.charts[made.set.patches[patch].chart];
        std::set<std::pair<int, int>> cells;
        for (const auto& [x, y] : squares)
            cells.insert({(x - static_cast<int>(chart.x)) / 8, (y - static_cast<int>(chart.y)) / 8});
        EXPECT_EQ(cells.size(), 1u);
    }
}

TEST(PatchBuild, NamesDoNotDependOnOtherObjects) {
    Scene before, after;
    test::add_object(before, "sphere", test::sphere(20, 0.7f), 2);
    test::add_object(before, "box", test::box(2, 1, 3), 1);
    test::add_object(after, "new", test::terrain(40, 0.1f, 2.0f), 5);
    test::add_object(after, "box", test::box(2, 1, 3), 1);
    test::add_object(after, "sphere", test::sphere(20, 0.7f), 2);
    const MadePatches a = make_patches(std::move(before)), b = make_patches(std::move(after));
    const auto by_id = [](const MadePatches& made) {
        std::map<PatchId, const Patch*> map;
        for (const Patch& p : made.set.patches) map[p.id] = &p;
        return map;
    };
    const auto in_a = by_id(a), in_b = by_id(b);
    bool moved = false;
    for (const auto& [id, patch] : in_a) {
        const auto found = in_b.find(id);
        ASSERT_NE(found, in_b.end());
        EXPECT_EQ(found->second->area_m2, patch->area_m2);
        EXPECT_EQ(found->second->center, patch->center);
        EXPECT_EQ(found->second->normal, patch->normal);
        const Chart &ca = a.atlas.charts[patch->chart], &cb = b.atlas.charts[found->second->chart];
        moved = moved || ca.x != cb.x || ca.y != cb.y || ca.page != cb.page;
    }
    EXPECT_TRUE(moved) << "the test wants charts to be packed elsewhere";
}

TEST(PatchBuild, DoesNotDependOnThreads) {
    std::vector<MadePatches> made;
    for (const unsigned threads : {1u, 2u}) {
        const ThreadLimit limit(threads);
        made.push_back(make_patches(test::coloured_scene()));
    }
    ASSERT_EQ(made[0].set.count(), made[1].set.count());
    for (PatchNumber p = 0; p < made[0].set.count(); ++p) {
        EXPECT_EQ(made[0].set.patches[p].id, made[1].set.patches[p].id);
        EXPECT_EQ(made[0].set.patches[p].center, made[1].set.patches[p].center);
    }
    EXPECT_EQ(made[0].set.page_patch, made[1].set.page_patch);
    EXPECT_EQ(made[0].set.fragment_begin, made[1].set.fragment_begin);
}

TEST(PatchBuild, RefusesTwoObjectsOfOneName) {
    Scene scene;
    test::add_object(scene, "box", test::box(2, 1, 3), 1);
    test::add_object(scene, "box", test::box(2, 1, 3), 1, [](const Vec3f& p) { return p + Vec3f(9, 0, 0); });
    EXPECT_THROW(make_patches(std::move(scene)), Error);
    EXPECT_THROW(make_patches(test::coloured_scene(), 23, 0), Error);
}

TEST(PatchLookup, FindsThePatchOfEveryFragment) {
    const MadePatches made = make_patches(test::coloured_scene());
    for (PatchNumber p = 0; p < made.set.count(); ++p)
        for (const Fragment& f : made.set.fragments_of(p)) {
            const Vec2f b = fragment_polygon(made.scene, made.atlas, f).centroid();
            if (f.area_m2 < 1e-9f) continue;  // the point may round into the next texel
            EXPECT_EQ(front_patch_at(made.scene, made.atlas, made.set, f.triangle, b.x, b.y), p);
        }
}

TEST(PatchLookup, EveryPointHasAPatch) {
    const MadePatches made = make_patches(test::coloured_scene());
    for (std::uint32_t t = 0; t < made.scene.triangle_count(); ++t) {
        const SobolSequence sequence(t);
        for (std::uint32_t i = 0; i < 16; ++i) {
            auto p = sequence.point(i);
            if (i < 3) p = {i == 1 ? 1.0f : 0.0f, i == 2 ? 1.0f : 0.0f, 0, 0};  // the corners
            if (p[0] + p[1] > 1) p = {1 - p[0], 1 - p[1], 0, 0};
            const PatchNumber patch = front_patch_at(made.scene, made.atlas, made.set, t, p[0], p[1]);
            ASSERT_NE(patch, no_patch) << t;
            EXPECT_EQ(made.set.patches[patch].chart, made.atlas.triangle_chart[t]);
        }
    }
}

}  // namespace
}  // namespace luxel
