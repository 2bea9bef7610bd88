/// Tiles: a permutation, never too large, and local: what moves changes the tiles it leaves and enters, and no others.
#include "baker/chunks/spatial_tiles.h"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <set>

#include "baker/chunks/space_halving.h"
#include "tests/unit/chunks/chunk_sets.h"

namespace luxel {
namespace {

using test::chunks_of;
using test::expect_valid;

PatchSet random_patches(std::size_t count, unsigned seed, float size = 10) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<float> place(-size, size);
    PatchSet set;
    for (std::size_t p = 0; p < count; ++p) {
        Patch patch;
        patch.normal = patch.reflectance = patch.emission = Vec3f(0, 1, 0);
        patch.id = p + 1;
        patch.center = {place(random), place(random) / 5, place(random)};
        patch.area_m2 = 1;
        set.patches.push_back(patch);
    }
    return set;
}

TEST(SpatialTiles, NumbersAreAPermutationAndChunksAreSmall) {
    for (const std::size_t count : {0u, 1u, 2u, 100u, 3000u})
        for (const std::uint32_t limit : {1u, 7u, 64u, 65536u}) {
            const PatchSet set = random_patches(count, 1);
            expect_valid(set, tile_patches(set, {limit}), limit);
        }
    const PatchSet few = random_patches(100, 2);
    EXPECT_EQ(tile_patches(few, {100}).layout.chunk_count(), 1u);
    EXPECT_EQ(tile_patches(random_patches(0, 1), {100}).layout.chunk_count(), 0u);
}

TEST(SpatialTiles, ManyPatchesAtOnePoint) {
    for (const Vec3f& place : {Vec3f(0, 0, 0), Vec3f(1, 2, 3), Vec3f(-1e-30f, 1e20f, 0)}) {
        PatchSet set = random_patches(1000, 3, 1);
        for (std::size_t p = 100; p < 900; ++p) set.patches[p].center = place;
        expect_valid(set, tile_patches(set, {64}), 64);
    }
}

TEST(SpatialTiles, AllSizesOfScenes) {
    for (const float size : {1e-30f, 1e-4f, 1e6f, 1e30f}) {
        const PatchSet set = random_patches(500, 4, size);
        const Tiling tiling = tile_patches(set, {50});
        expect_valid(set, tiling, 50);
        EXPECT_LT(tiling.layout.chunk_count(), 60u) << "tiles are not emptier at other scales";
    }
}

/// Tiles as sets of ids, so that they can be compared between two tilings.
std::set<std::vector<PatchId>> tiles(const PatchSet& set, std::uint32_t limit) {
    const auto chunks = chunks_of(set, tile_patches(set, {limit}));
    return {chunks.begin(), chunks.end()};
}

TEST(SpatialTiles, AMovedPatchChangesOnlyWhatItLeavesAndEnters) {
    PatchSet set = random_patches(4000, 5);
    set.patches[0].center = {10, 2, 10};  // the farthest one stays, so the first box does
    std::mt19937_64 random(6);
    std::uniform_real_distribution<float> place(-9, 9);
    const auto before = tiles(set, 64);
    std::size_t most = 0;
    for (int round = 0; round < 50; ++round) {
        PatchSet moved = set;
        const PatchId id = 2 + random() % (set.count() - 1);
        moved.patches[id - 1].center = {place(random), place(random) / 5, place(random)};
        std::size_t changed = 0;
        for (const auto& tile : tiles(moved, 64)) changed += !before.contains(tile);
        // It leaves one tile (whose neighbours may then be joined) and enters one (which may be halved, more than once
        // where patches are close).
        most = std::max(most, changed);
        EXPECT_LE(changed, 5u);
    }
    EXPECT_GE(most, 2u);
}

TEST(SpatialTiles, MoreSceneInsideTheBoxLeavesTheOthersAlone) {
    PatchSet set = random_patches(3000, 7);
    PatchSet grown = set;
    Patch patch = set.patches[0];
    for (PatchId id = 5000; id < 5100; ++id) {
        patch.id = id;
        patch.center = {9.5f + 0.001f * static_cast<float>(id % 10), 1, -9.5f};
        grown.patches.push_back(patch);
    }
    const auto before = tiles(set, 64);
    std::size_t kept = 0;
    for (const auto& tile : tiles(grown, 64)) kept += before.contains(tile);
    EXPECT_GE(kept, before.size() - 1);
}

TEST(SpaceHalving, SizesCountAndLargeThingsStandAlone) {
    const std::vector<Vec3d> places{{1, 0, 0}, {1.5, 0, 0}, {3, 0, 0}, {-1, 0, 0}, {3, 0, 0}};
    const std::vector<std::uint32_t> sizes{2, 3, 4, 9, 1};
    using Groups = std::vector<std::vector<std::uint32_t>>;
    EXPECT_EQ(halve_space(places, sizes, {0, 1, 2, 3, 4}, 5), (Groups{{3}, {0, 1}, {2, 4}}));
    EXPECT_EQ(halve_space(places, sizes, {0, 2, 4}, 4), (Groups{{0}, {2}, {4}}))
        << "things at one place, in their order";
    EXPECT_EQ(halve_space(places, sizes, {4, 1}, 100), (Groups{{4, 1}}));
    EXPECT_TRUE(halve_space(places, sizes, {}, 1).empty());
}

TEST(ChunkLayout, ChunkOfSkipsEmptyChunks) {
    ChunkLayout layout;
    layout.first_patch = {0, 3, 3, 5, 5};
    EXPECT_EQ(layout.chunk_count(), 4u);
    for (PatchNumber p = 0; p < 5; ++p) {
        const ChunkNumber c = layout.chunk_of(p);
        EXPECT_LE(layout.first_patch[c], p);
        EXPECT_LT(p, layout.first_patch[c + 1]);
    }
}

}  // namespace
}  // namespace luxel
