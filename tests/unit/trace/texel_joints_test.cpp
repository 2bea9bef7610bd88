/// What stands on a surface parts its texels, however thin it is; what does not, does not.
#include "baker/trace/texel_joints.h"

#include <gtest/gtest.h>

#include <set>

#include "baker/patches/fragment_polygon.h"
#include "baker/patches/patch_sampler.h"
#include "baker/trace/surface_map.h"
#include "tests/support/scenes.h"

namespace luxel {
namespace {

using test::moved;
using test::quad;
using test::SceneMaker;

/// Joints that are cut among the texels of the object `path`.
std::size_t cut_joints(const test::Prepared& made, const std::string& path) {
    std::size_t cut = 0;
    for (const PageTexels& page : made.texels.pages)
        for (const Texel& texel : page.texels) {
            const Object& object = made.scene.objects[made.atlas.charts[texel.chart].object];
            if (made.scene.materials[object.material].name == path)
                cut += !texel.joined_right + std::size_t{!texel.joined_down};
        }
    return cut;
}

/// Texels of the floor that are known to be beside something.
std::size_t floor_contacts(const test::Prepared& made) {
    std::size_t count = 0;
    for (std::uint32_t page = 0; page < made.texels.pages.size(); ++page)
        for (const Texel& texel : made.texels.pages[page].texels) {
            const Object& object = made.scene.objects[made.atlas.charts[texel.chart].object];
            if (made.scene.materials[object.material].name == "floor")
                count += made.patches.contacts.holds(page, std::size_t{texel.y} * made.texels.page_size + texel.x);
        }
    return count;
}

/// Both sides of the sheet x = at that patches of `path` have fragments on by more than a texel, as sets of patches.
bool any_patch_on_both_sides(const test::Prepared& made, const std::string& path, double at, double margin) {
    std::set<PatchNumber> left, right;
    for (PatchNumber p = 0; p < made.patches.count(); ++p) {
        if (made.path_of(p) != path) continue;
        for (const Fragment& fragment : made.patches.fragments_of(p)) {
            const Vec2f b = fragment_polygon(made.scene, made.atlas, fragment).centroid();
            const double x =
                static_cast<double>(surface_position(made.scene, fragment.triangle, b).x) + made.scene.origin.x;
            if (x < at - margin) left.insert(p);
            if (x > at + margin) right.insert(p);
        }
    }
    for (const PatchNumber p : left)
        if (right.contains(p)) return true;
    return false;
}

/// A floor of 4 x 4 m with an upright two-sided sheet without thickness across the middle of a cell of texels.
test::SceneMaker floor_with_sheet(double x, bool sheet) {
    test::MadeMaterial both;
    both.double_sided = true;
    SceneMaker maker;
    maker.add("floor", quad({0, 0, 0}, {0, 0, 4}, {4, 0, 0}));
    if (sheet) maker.add("sheet", quad({0, 0, 0}, {0, 0, 4}, {0, 2, 0}), both, {x, 0, 0});
    maker.add("far", quad({0, 5, 0}, {4, 0, 0}, {0, 0, 4}));  // light for both sides
    return maker;
}

/// Patches that rays from above meet on the floor at these x, metres, along its whole depth.
std::set<PatchNumber> met_at(const test::Prepared& made, const std::vector<double>& xs) {
    std::set<PatchNumber> met;
    for (const double x : xs)
        for (int k = 0; k < 100; ++k) {
            const Vec3d from(x - made.scene.origin.x, 1 - made.scene.origin.y, 0.02 + 0.0396 * k - made.scene.origin.z);
            const Landing at = landing(made.scene, made.atlas, made.patches, made.tracer->first_hit({to_float(from), {0, -1, 0}, none}));
            if (at.end == RayEnd::patch) met.insert(at.patch);
        }
    return met;
}

/// The sheet runs through the middle of a column of texels: no patch receives light on both sides of it, and none sends where
/// it does not receive, to a cell: which of a texel are on which side their middles decide, and those of its triangles are slanted.
TEST(TexelJoints, NoPatchReachesThroughASheetInsideATexel) {
    const double texel = 1.0 / 8, cell = texel / 4;
    for (const double x : {2 + 1.3 * texel, 2 + 1.5 * texel, 2 + 3.7 * texel}) {
        const auto made = test::prepare(floor_with_sheet(x, true).build());
        std::vector<double> left, right;
        for (const double away : {0.51 * cell, cell, 0.4 * texel, 0.9 * texel, 2 * texel}) left.push_back(x - away), right.push_back(x + away);
        const std::set<PatchNumber> on_left = met_at(*made, left), on_right = met_at(*made, right);
        EXPECT_GE(on_left.size(), 8u);
        EXPECT_GE(on_right.size(), 8u);
        for (const PatchNumber p : on_left) EXPECT_FALSE(on_right.contains(p)) << x;
        for (const auto& [patches, side] : {std::pair{&on_left, -1.0}, {&on_right, 1.0}})
            for (const PatchNumber p : *patches) {
                const PatchSampler sampler(made->scene, made->atlas, made->patches, p);
                for (float u = 0.01f; u < 1; u += 0.06f)
                    for (float v = 0.01f; v < 1; v += 0.06f) {
                        const double at = static_cast<double>(sampler.point(u, v).position.x) + made->scene.origin.x;
                        EXPECT_GT(side * (at - x), -cell) << "patch " << p << " of the sheet at " << x;
                    }
            }
    }
    EXPECT_TRUE(test::prepare(floor_with_sheet(2.2, false).build())->patches.parted.empty());
}

TEST(TexelJoints, ASheetPartsThePatchesOfTheFloor) {
    const double texel = 1.0 / 8;
    for (const double x : {2.0 + 0.02, 2.0 + 1.3 * texel, 2.0 + 2.01 * texel}) {
        const auto made = test::prepare(floor_with_sheet(x, true).build());
        // Each row of texels across is cut once.
        EXPECT_EQ(cut_joints(*made, "floor"), 32u) << x;
        EXPECT_EQ(floor_contacts(*made), 64u) << x;  // both of each joint
        EXPECT_FALSE(any_patch_on_both_sides(*made, "floor", x, 1.01 * texel)) << x;
    }
    const auto open = test::prepare(floor_with_sheet(2.2, false).build());
    EXPECT_EQ(cut_joints(*open, "floor"), 0u);
    EXPECT_EQ(floor_contacts(*open), 0u);
    EXPECT_TRUE(any_patch_on_both_sides(*open, "floor", 2.2, 1.01 * texel));
}

TEST(TexelJoints, CurvedSurfacesHangTogether) {
    for (const bool inside : {false, true}) {
        const auto ball = test::icosphere(3, 1);
        const auto made = test::prepare(SceneMaker().add("ball", inside ? test::turned(ball) : ball).build());
        EXPECT_EQ(cut_joints(*made, "ball"), 0u);
    }
}

TEST(TexelJoints, WhatHangsAboveDoesNotPart) {
    const auto made = test::prepare(SceneMaker()
                                        .add("floor", quad({0, 0, 0}, {0, 0, 4}, {4, 0, 0}))
                                        .add("table", moved(test::box(1, 0.1f, 1), {1.3f, 0.7f, 1.3f}))
                                        .build());
    EXPECT_EQ(cut_joints(*made, "floor"), 0u);
}

/// A wall with a thickness hides the floor beneath it: its two sides must not hang together through what is hidden.
TEST(TexelJoints, AThickWallParts) {
    const auto made = test::prepare(SceneMaker()
                                        .add("floor", quad({0, 0, 0}, {0, 0, 4}, {4, 0, 0}))
                                        .add("wall", moved(test::box(0.2f, 2, 4.2f), {1.91f, -0.1f, -0.1f}))
                                        .build());
    EXPECT_GT(cut_joints(*made, "floor"), 0u);
    EXPECT_FALSE(any_patch_on_both_sides(*made, "floor", 2.0, 0.1));
}

}  // namespace
}  // namespace luxel
