/// The plan's shares fit the budget, the floor is exact, and more budget never gives less.
#include "baker/bake/memory_plan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>

#include "baker/formfactors/sky_view.h"
#include "formats/base/error.h"

namespace luxel {
namespace {

constexpr std::uint64_t mebibyte = 1 << 20;

using Size = MemoryDemand;
const Size sizes[]{
    {.fixed_bytes = 20 * mebibyte},
    {.fixed_bytes = 60 * mebibyte, .patch_count = 50'000, .chunk_patches = 2048, .page_size = 1024, .threads = 2},
    {.fixed_bytes = 300 * mebibyte, .patch_count = 10'000'000, .chunk_patches = 4096, .page_size = 4096, .page_count = 10, .threads = 16}};

MemoryPlan plan(std::uint64_t budget, Size size, bool previews = false, SolverKind solver = SolverKind::shoot) {
    size.previews = previews, size.solver = solver;
    return plan_memory(budget, size);
}

/// The smallest budget that the message names, in bytes.
std::uint64_t stated_floor(const Size& size) {
    try {
        plan(1, size);
    } catch (const Error& error) {
        EXPECT_EQ(error.code, ErrorCode::budget_too_small);
        const auto at = error.hint.find_first_of("0123456789");
        return std::stoull(error.hint.substr(at)) * mebibyte;
    }
    ADD_FAILURE() << "one byte was enough";
    return 0;
}

TEST(MemoryPlan, TheStatedFloorWorksAndLessDoesNot) {
    for (const Size& size : sizes) {
        const std::uint64_t floor = stated_floor(size);
        const MemoryPlan at_floor = plan(floor, size);
        EXPECT_LE(at_floor.floor_bytes, floor);
        EXPECT_GT(at_floor.floor_bytes + mebibyte, floor);
        EXPECT_NO_THROW(plan(at_floor.floor_bytes, size));
        EXPECT_THROW(plan(at_floor.floor_bytes - 1, size), Error);
        EXPECT_GE(at_floor.floor_bytes, size.fixed_bytes);
    }
}

TEST(MemoryPlan, LayersTakeThePlaceOfTheLightmap) {
    const std::uint64_t budget = std::uint64_t{1} << 40;
    // Where pages are large beside the solve, they decide.
    const auto floor = [&](std::uint64_t layer_bytes_per_texel) {
        return plan_memory(budget, {.fixed_bytes = 20 * mebibyte, .patch_count = 100, .page_size = 8192,
                                    .layer_bytes_per_texel = layer_bytes_per_texel})
            .floor_bytes;
    };
    const std::uint64_t texels = std::uint64_t{8192} * 8192;
    EXPECT_EQ(floor(1), floor(0)) << "less than the lightmap takes";
    EXPECT_EQ(floor(200) - floor(100), 100 * texels);
    EXPECT_GE(floor(200), 200 * texels);
}

TEST(MemoryPlan, PicturesOfAllPagesAreKept) {
    const auto floor = [&](std::uint32_t pages, std::uint64_t picture_bytes_per_texel) {
        return plan_memory(std::uint64_t{1} << 40, {.fixed_bytes = 20 * mebibyte, .patch_count = 100, .page_size = 8192, .page_count = pages,
                                                    .picture_bytes_per_texel = picture_bytes_per_texel})
            .floor_bytes;
    };
    const std::uint64_t texels = std::uint64_t{8192} * 8192;
    EXPECT_EQ(floor(5, 8) - floor(5, 3), 5 * 5 * texels);
    EXPECT_EQ(floor(6, 8) - floor(5, 8), 8 * texels);
}

TEST(MemoryPlan, ConjugateGradientsNeedMoreThanShooting) {
    for (const Size& size : sizes) {
        const std::uint64_t budget = std::uint64_t{1} << 40;
        const MemoryPlan shoot = plan(budget, size), cg = plan(budget, size, false, SolverKind::cg);
        EXPECT_GE(cg.floor_bytes, shoot.floor_bytes + 200 * size.patch_count);
        EXPECT_LE(cg.cache_bytes, shoot.cache_bytes);
    }
}

TEST(MemoryPlan, SharesFitTheBudget) {
    for (const Size& size : sizes) {
        std::uint64_t last_pooling = 0, last_cache = 0;
        for (std::uint64_t budget = stated_floor(size); budget < (std::uint64_t{1} << 40); budget = budget * 5 / 4) {
            const MemoryPlan p = plan(budget, size);
            EXPECT_LE(std::max(p.pooling_bytes, p.cache_bytes) + size.fixed_bytes + size.patch_count * 64, budget);
            EXPECT_GE(p.pooling_bytes, 8 * mebibyte) << "what pooling uses at least";
            EXPECT_GE(p.pooling_bytes, last_pooling);
            EXPECT_GE(p.cache_bytes, last_cache);
            last_pooling = p.pooling_bytes, last_cache = p.cache_bytes;
        }
    }
}

TEST(MemoryPlan, PreviewsComeBesideTheSolve) {
    constexpr std::uint64_t budget = std::uint64_t{1} << 36;
    for (const Size& size : sizes) {
        const std::uint64_t page = std::uint64_t{size.page_size} * size.page_size * 3;  // at the least
        EXPECT_GE(plan(budget, size, true).floor_bytes, plan(budget, size).floor_bytes + size.patch_count * 36 + page);
        EXPECT_LE(plan(budget, size, true).cache_bytes + page / 2, plan(budget, size).cache_bytes);
    }
}

TEST(MemoryPlan, JoiningSeamsIsCountedWhileWriting) {
    const auto floor = [](std::uint64_t seam_bytes) {
        Size size = sizes[1];
        size.seam_bytes = seam_bytes;
        return plan(std::uint64_t{1} << 40, size).floor_bytes;
    };
    constexpr std::uint64_t much = std::uint64_t{1} << 34;
    EXPECT_GE(floor(0) + much, floor(much));
    EXPECT_EQ(floor(2 * much), floor(much) + much);
}

TEST(MemoryPlan, GatheringHoldsAPageAndTheDetailOfAll) {
    Size size = sizes[2];
    const std::uint64_t without = plan(std::uint64_t{1} << 40, size).floor_bytes;
    size.gathers = true;
    const std::uint64_t ten = plan(std::uint64_t{1} << 40, size).floor_bytes;
    size.page_count = 1010;
    const std::uint64_t thousand = plan(std::uint64_t{1} << 40, size).floor_bytes;
    EXPECT_GE(ten, without);
    EXPECT_GE(thousand - ten, std::uint64_t{900} * 4 * size.page_size * size.page_size);
}

TEST(MemoryPlan, ASkyIsCountedOnlyWhereThereIsOne) {
    const auto floor = [](Size size, std::uint32_t width, std::uint32_t height) {
        size.sky_width = width, size.sky_height = height;
        return plan(std::uint64_t{1} << 40, size).floor_bytes;
    };
    const std::uint64_t pixels = std::uint64_t{2048} * 1024;
    // Of a small scene the picture decides: its bright part, and the table for aiming at it.
    const Size& small = sizes[0];
    EXPECT_GE(floor(small, 2048, 1024), small.fixed_bytes + 16 * pixels);
    EXPECT_LE(floor(small, 2048, 1024), small.fixed_bytes + 32 * mebibyte + 17 * pixels + 4 * mebibyte);
    EXPECT_EQ(floor(small, 1, 1), floor(small, 0, 0)) << "a sky of one colour has no tables";
    // While a large scene is gathered there are only the table and, per thread, a block of what patches see of it.
    Size large = sizes[2];
    large.gathers = true;
    EXPECT_GE(floor(large, 2048, 1024), floor(large, 0, 0) + 4 * pixels);
    EXPECT_LE(floor(large, 2048, 1024), floor(large, 0, 0) + 5 * pixels + large.threads * sky_view_read_bytes);
}

TEST(MemoryPlan, WhatWasHeldBeforeIsPartOfTheFloor) {
    const auto floor = [](std::uint64_t past_peak_bytes) {
        Size size = sizes[0];
        size.past_peak_bytes = past_peak_bytes;
        return plan(std::uint64_t{1} << 40, size).floor_bytes;
    };
    EXPECT_EQ(floor(sizes[0].fixed_bytes), floor(0)) << "no more than is resident now";
    EXPECT_GT(floor(700 * mebibyte), 700 * mebibyte);
    EXPECT_LE(floor(700 * mebibyte), 732 * mebibyte) << "nothing comes beside it";
}

TEST(MemoryPlan, ColoursOfPanesAreCountedOnlyWhereThereArePanes) {
    Size size = sizes[2];
    size.gathers = true;
    const std::uint64_t without = plan(std::uint64_t{1} << 40, size).floor_bytes;
    size.has_tinting_panes = true;
    EXPECT_EQ(plan(std::uint64_t{1} << 40, size).floor_bytes, without + size.patch_count * 12);
}

TEST(MemoryPlan, TheFloorGrowsWithTheScene) {
    EXPECT_LT(stated_floor(sizes[0]), stated_floor(sizes[1]));
    EXPECT_LT(stated_floor(sizes[1]), stated_floor(sizes[2]));
}

}  // namespace
}  // namespace luxel
