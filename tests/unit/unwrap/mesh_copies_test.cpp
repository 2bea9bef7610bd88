// Copies of a mesh share one layout, each in a block of its own.
#include "baker/unwrap/mesh_copies.h"

#include <gtest/gtest.h>

#include "baker/unwrap/unwrap.h"
#include "tests/unit/unwrap/made_scene.h"

namespace luxel {
namespace {

using test::add_object;

constexpr double large = 1e9;  // texels: nothing is too large for a page

auto stretched(const Vec3f& by, const Vec3f& place) {
    return [=](const Vec3f& p) { return p * by + place; };
}

/// A sphere, and copies: moved, mirrored, half as large, flattened, and one too small to share.
Scene spheres() {
    Scene scene;
    const test::MadeMesh mesh = test::sphere(12, 1);
    add_object(scene, "half", mesh, 7, stretched({0.5f, 0.5f, 0.5f}, {9, 0, 0}));
    add_object(scene, "own", mesh, 7);
    add_object(scene, "box", test::box(1, 2, 3), 8);
    add_object(scene, "moved", mesh, 7, stretched({1, 1, 1}, {3, 0, 0}));
    add_object(scene, "mirrored", mesh, 7, stretched({-1, 1, 1}, {6, 0, 0}), true);
    add_object(scene, "flat", mesh, 7, stretched({1, 0.3f, 1}, {12, 0, 0}));
    add_object(scene, "tiny", mesh, 7, stretched({0.2f, 0.2f, 0.2f}, {15, 0, 0}));
    return scene;
}

std::vector<std::uint32_t> objects_of(const CopyGroup& group) {
    std::vector<std::uint32_t> objects;
    for (const ObjectRun& run : group.instances) objects.push_back(run.first);
    std::sort(objects.begin(), objects.end());
    return objects;
}

TEST(MeshCopies, ShareUpToFourTimesSmaller) {
    const std::vector<CopyGroup> groups = find_copies(spheres(), 1, large);
    ASSERT_EQ(groups.size(), 1u);
    EXPECT_EQ(objects_of(groups[0]), (std::vector<std::uint32_t>{0, 1, 3, 4, 5}));
    EXPECT_NE(groups[0].instances[0].first, 0u) << "the layout is that of a large one";
}

TEST(MeshCopies, OfMeshesLargerThanAPageShareWithTheirLikeOnly) {
    const std::vector<CopyGroup> groups = find_copies(spheres(), 1, 1);
    ASSERT_EQ(groups.size(), 1u);
    EXPECT_EQ(objects_of(groups[0]), (std::vector<std::uint32_t>{1, 3, 4}));
}

TEST(MeshCopies, ShareAtOneDensityAndOnlyWithALightmap) {
    Scene scene = spheres();
    scene.objects[3].texels_per_metre = 2;
    scene.objects[4].has_lightmap = false;
    const std::vector<CopyGroup> groups = find_copies(scene, 1, large);
    ASSERT_EQ(groups.size(), 1u);
    EXPECT_EQ(objects_of(groups[0]), (std::vector<std::uint32_t>{0, 1, 5}));
}

TEST(MeshCopies, TakeAllPrimitivesOfTheirInstance) {
    Scene scene;
    for (std::uint32_t instance = 0; instance < 3; ++instance)
        for (std::uint32_t primitive = 0; primitive < 2; ++primitive) {
            Object& object = add_object(scene, "part", test::box(1, 1, 1), instance == 2 ? 1 : 1 + primitive, stretched({1, 1, 1}, {3.0f * static_cast<float>(instance), 0, 0}));
            object.instance = instance;
            object.primitive = primitive;
        }
    const std::vector<CopyGroup> groups = find_copies(scene, 1, large);
    ASSERT_EQ(groups.size(), 1u) << "the third shows another mesh";
    EXPECT_EQ(objects_of(groups[0]), (std::vector<std::uint32_t>{0, 2}));
    EXPECT_EQ(groups[0].instances[0].count, 2u);
}

TEST(MeshCopies, OneOfASharedNodeHasAPlaceToo) {
    Scene scene;
    add_object(scene, "only", test::box(1, 1, 1), 1).shares_node = true;
    add_object(scene, "other", test::box(1, 1, 2), 2);
    const std::vector<CopyGroup> groups = find_copies(scene, 1, large);
    ASSERT_EQ(groups.size(), 1u);
    EXPECT_EQ(objects_of(groups[0]), std::vector<std::uint32_t>{0});
}

Vec2f in_block(const Atlas& atlas, const CopyBlock& block, const Object& object, std::uint32_t triangle, std::size_t corner) {
    const std::size_t k = object.mirrored && corner ? 3 - corner : corner;
    return atlas.page_uv(object.first_triangle + triangle, static_cast<int>(k)) - Vec2f(static_cast<float>(block.x), static_cast<float>(block.y));
}

TEST(MeshCopies, LieInBlocksOfOneArrangement) {
    const Scene scene = spheres();
    UnwrapOptions options;
    options.texels_per_metre = 20;
    options.page_size = 256;
    std::vector<Warning> warnings;
    const Atlas atlas = unwrap(scene, options, warnings, {});
    ASSERT_EQ(atlas.copy_blocks.size(), 5u);
    const Object& first = scene.objects[atlas.copy_blocks[0].first_object];
    for (const CopyBlock& block : atlas.copy_blocks) {
        EXPECT_EQ(block.width, atlas.copy_blocks[0].width);
        EXPECT_EQ(block.height, atlas.copy_blocks[0].height);
        const Object& object = scene.objects[block.first_object];
        for (std::uint32_t t = 0; t < object.triangle_count; ++t)
            for (std::size_t k = 0; k < 3; ++k) {
                const Vec2f a = in_block(atlas, block, object, t, k), b = in_block(atlas, atlas.copy_blocks[0], first, t, k);
                EXPECT_NEAR(a.x, b.x, 1e-4);
                EXPECT_NEAR(a.y, b.y, 1e-4);
            }
        for (const Chart& chart : atlas.charts) {
            const bool is_elsewhere = chart.page != block.page || chart.x >= block.x + block.width + atlas.padding ||
                                      chart.x + chart.width + atlas.padding <= block.x || chart.y >= block.y + block.height + atlas.padding ||
                                      chart.y + chart.height + atlas.padding <= block.y;
            EXPECT_TRUE(chart.object == block.first_object || is_elsewhere) << "nothing else lies in a block or its padding";
        }
    }
    options.instances = InstanceMode::split;
    EXPECT_TRUE(unwrap(scene, options, warnings, {}).copy_blocks.empty());
}

TEST(MeshCopies, WithoutRoomForABlockArePackedChartByChart) {
    Scene scene;
    add_object(scene, "own", test::box(1, 1, 1), 1);
    add_object(scene, "copy", test::box(1, 1, 1), 1, stretched({1, 1, 1}, {3, 0, 0}));
    UnwrapOptions options;
    options.texels_per_metre = 40;
    options.page_size = 64;  // one face fills most of a page
    std::vector<Warning> warnings;
    const Atlas atlas = unwrap(scene, options, warnings, {});
    EXPECT_TRUE(atlas.copy_blocks.empty());
    EXPECT_TRUE(std::any_of(warnings.begin(), warnings.end(), [](const Warning& w) { return w.code == "copies-without-block"; }));
    EXPECT_EQ(atlas.triangle_chart.size(), 24u);
}

}  // namespace
}  // namespace luxel
