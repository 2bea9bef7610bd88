/// Exact at the extremes, for all solvers: brightness, reflectance near 1, areas, scenes that fall apart or hold nothing.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>

#include "baker/solver/solve.h"
#include "formats/base/error.h"
#include "tests/support/solver_kinds.h"
#include "tests/unit/solver/matrices.h"

namespace luxel {
namespace {

using test::even_layout;
using test::Matrix;
using test::random_matrix;

std::vector<Rgb> grey(std::size_t count, float value) { return std::vector<Rgb>(count, Rgb(value, value, value)); }

void expect_finite(const SolveResult& result) {
    for (const auto* values : {&result.radiosity, &result.unshot, &result.irradiance})
        for (const Channels& value : *values)
            for (const double number : value) ASSERT_TRUE(std::isfinite(number));
    EXPECT_TRUE(std::isfinite(result.error_bound));
}

class SolverExtremes : public testing::TestWithParam<SolverKind> {
  protected:
    static SolveResult run(BlockSource& blocks, const std::vector<Rgb>& reflectance, const std::vector<Channels>& emission,
                           double tolerance = 1e-3, std::uint64_t max_reads = 100'000) {
        SolveOptions options;
        options.tolerance = tolerance;
        options.max_reads = max_reads;
        return solve(GetParam(), blocks, {reflectance, emission}, options);
    }
    static SolveResult run(const Matrix& matrix, const std::vector<Rgb>& reflectance, const std::vector<Channels>& emission,
                           double tolerance = 1e-3, std::uint64_t max_reads = 100'000) {
        MemoryBlocks blocks = matrix.blocks();
        return run(blocks, reflectance, emission, tolerance, max_reads);
    }
    /// Light that bounces a thousand or a million times is another matter for some: the series of bounces, sweeps, and shots of single
    /// patches may take as many reads as it. What they say of their error must hold then.
    static bool must_reach(float rho) {
        if (GetParam() == SolverKind::cg || GetParam() == SolverKind::shoot) return true;
        return rho < 0.9999f && GetParam() != SolverKind::shoot_patch;
    }
};

TEST_P(SolverExtremes, BrightnessChangesNothing) {
    const Matrix matrix = random_matrix({.patches = 100, .chunk_patches = 30, .closed = false}, 5);
    const auto reflectance = test::random_reflectance(100, 0.1f, 0.95f, 3);
    const auto emission = test::random_emission(100, 4);
    const SolveResult plain = run(matrix, reflectance, emission);
    for (const double factor : {1e-30, 1e30, 1e-300, 1e300}) {
        auto scaled = emission;
        for (Channels& m : scaled)
            for (double& value : m) value *= factor;
        const SolveResult result = run(matrix, reflectance, scaled);
        expect_finite(result);
        for (std::size_t i = 0; i < 100; ++i)
            for (std::size_t c = 0; c < 3; ++c) {
                EXPECT_NEAR(result.radiosity[i][c] / factor, plain.radiosity[i][c], 1e-6 * plain.radiosity[i][c]);
                EXPECT_NEAR(result.irradiance[i][c] / factor, plain.irradiance[i][c], 1e-6 * plain.irradiance[i][c]);
            }
    }
    // Bright and faint lamps in one scene.
    auto mixed = emission;
    mixed[0] = {1e30, 1e30, 1e30};
    mixed[1] = {1e-30, 1e-30, 1e-30};
    const SolveResult result = run(matrix, reflectance, mixed);
    expect_finite(result);
    EXPECT_LE(test::true_error(matrix, reflectance, mixed, result.radiosity), result.error_bound);
}

/// What an error bound of the total promises of the mean of a closed room: M / (1 - rho), whoever emits.
void expect_mean(const Matrix& matrix, const SolveResult& result, float rho) {
    Channels mean{0, 0, 0};
    double area = 0;
    for (std::size_t i = 0; i < matrix.count(); ++i) {
        area += matrix.area_m2[i];
        for (std::size_t c = 0; c < 3; ++c) mean[c] += matrix.area_m2[i] * result.radiosity[i][c];
    }
    for (std::size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(mean[c] / area * (1 - static_cast<double>(rho)) / static_cast<double>(c + 1), 1.0, 1e-3);
}

TEST_P(SolverExtremes, ReflectanceNearOneInAClosedRoom) {
    for (const std::size_t chunk_patches : {60u, 16u}) {
        const Matrix matrix = random_matrix({.patches = 60, .chunk_patches = chunk_patches}, 1);
        double area = 0;
        for (const double a : matrix.area_m2) area += a;
        std::vector<Channels> one_lamp(matrix.count(), {0, 0, 0});
        one_lamp[7] = {area / matrix.area_m2[7], 2 * area / matrix.area_m2[7], 3 * area / matrix.area_m2[7]};
        for (const float rho : {0.999f, 1 - 1e-6f})
            for (const auto& emission : {std::vector<Channels>(matrix.count(), {1, 2, 3}), one_lamp}) {
                const bool must = must_reach(rho);
                const auto reflectance = grey(matrix.count(), rho);
                const auto begin = std::chrono::steady_clock::now();
                const SolveResult result = run(matrix, reflectance, emission, 1e-4, must ? 10000 : 1000);
                const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
                std::printf("%s: %u chunks, rho 1 - %.0e, %s: bound %.1e after %.1f reads, %.3f s\n", result.solver.c_str(),
                            matrix.layout.chunk_count(), 1 - static_cast<double>(rho), emission[0][0] > 0 ? "all emit" : "one lamp",
                            result.error_bound, result.reads, seconds);
                EXPECT_LE(test::true_error(matrix, reflectance, emission, result.radiosity), result.error_bound + 1e-9);
                EXPECT_TRUE(result.converged || !must);
                if (result.converged) expect_mean(matrix, result, rho);
            }
    }
}

TEST_P(SolverExtremes, WhiteSurfacesWhereLightCanLeave) {
    Matrix matrix = random_matrix({.patches = 120, .chunk_patches = 20, .rooms = 2, .door = 0.1}, 5);
    for (std::size_t i = 0; i < 120; i += 5) matrix.diagonal_m2[i] -= 0.1 * matrix.area_m2[i];
    std::vector<Channels> emission(matrix.count(), {0, 0, 0});
    emission[3] = {1, 1, 1};
    const auto reflectance = grey(matrix.count(), 1.0f);
    const SolveResult result = run(matrix, reflectance, emission);
    EXPECT_TRUE(result.converged);
    EXPECT_LE(test::true_error(matrix, reflectance, emission, result.radiosity), result.error_bound);
}

TEST_P(SolverExtremes, OneNearlyWhiteSurfaceAmongDarkOnes) {
    const Matrix matrix = random_matrix({.patches = 120, .chunk_patches = 20}, 5);
    auto reflectance = grey(matrix.count(), 0.3f);
    reflectance[11] = {0.99f, 1.0f, 0.999999f};
    const auto emission = test::random_emission(matrix.count(), 4);
    const SolveResult result = run(matrix, reflectance, emission, 1e-6);
    EXPECT_TRUE(result.converged);
    const double error = test::true_error(matrix, reflectance, emission, result.radiosity);
    EXPECT_LE(error, result.error_bound);
    std::printf("one surface of 0.99 to 0.999999 among 0.3: bound %.1e, %.1f times the true error\n", result.error_bound, result.error_bound / error);
}

TEST_P(SolverExtremes, AreasOverTwelveOrdersOfMagnitude) {
    for (const bool closed : {true, false}) {
        const Matrix matrix = random_matrix({.patches = 150, .chunk_patches = 40, .area_decades = 12, .closed = closed}, 6);
        const auto reflectance = test::random_reflectance(150, 0.1f, 0.95f, 3);
        const std::vector<Channels> emission(150, {1, 1, 1});
        const SolveResult result = run(matrix, reflectance, emission, 1e-6);
        expect_finite(result);
        EXPECT_TRUE(result.converged);
        EXPECT_LE(test::true_error(matrix, reflectance, emission, result.radiosity), result.error_bound);
    }
}

TEST_P(SolverExtremes, SmallestScenes) {
    const SolveResult nothing = run(Matrix{ChunkLayout{}, {}, {}, {}}, {}, {});
    EXPECT_TRUE(nothing.converged);
    EXPECT_TRUE(nothing.radiosity.empty());

    const SolveResult one = run(Matrix{even_layout(1, 1), {2.0}, {0.0}, {}}, grey(1, 0.5f), {{1, 2, 3}});
    EXPECT_TRUE(one.converged);
    EXPECT_EQ(one.radiosity[0], (Channels{1, 2, 3}));
    EXPECT_EQ(one.reads, 0);

    // Alone, and half of what it sends comes back to it.
    const SolveResult hollow = run(Matrix{even_layout(1, 1), {2.0}, {1.0}, {}}, grey(1, 0.5f), {{3, 6, 9}}, 1e-9);
    EXPECT_NEAR(hollow.radiosity[0][0], 4, 1e-8);
    EXPECT_NEAR(hollow.radiosity[0][2], 12, 3e-8);

    // Two patches that see each other, and one that sees nothing, in the same chunk and in another.
    for (const std::size_t chunk_patches : {3u, 2u, 1u}) {
        const Matrix three{even_layout(3, chunk_patches), {1, 1, 1}, {0, 0, 0}, {{0, 1, 0.5f}}};
        const SolveResult result = run(three, grey(3, 0.5f), {{1, 1, 1}, {0, 0, 0}, {7, 7, 7}}, 1e-10);
        EXPECT_TRUE(result.converged);
        EXPECT_NEAR(result.radiosity[0][0], 1 / (1 - 0.0625), 1e-9);
        EXPECT_NEAR(result.radiosity[1][0], 0.25 / (1 - 0.0625), 1e-9);
        EXPECT_EQ(result.radiosity[2][0], 7);
        EXPECT_EQ(result.irradiance[2][0], 0);
    }
}

TEST_P(SolverExtremes, NoLight) {
    const Matrix matrix = random_matrix({.patches = 30, .chunk_patches = 10}, 3);
    for (const float rho : {0.0f, 0.5f, 1.0f}) {
        const SolveResult dark = run(matrix, grey(30, rho), std::vector<Channels>(30, {0, 0, 0}));
        EXPECT_TRUE(dark.converged);
        EXPECT_EQ(dark.reads, 0);
        EXPECT_EQ(dark.error_bound, 0);
        for (const Channels& b : dark.radiosity) EXPECT_EQ(b, (Channels{0, 0, 0}));
    }
}

/// Empty rows inside a chunk, a chunk whose rows are all empty, and a chunk that only others see.
TEST_P(SolverExtremes, EmptyRowsAndChunks) {
    Matrix matrix = random_matrix({.patches = 80, .chunk_patches = 20, .density = 0.8, .closed = false}, 12);
    const auto is_alone = [](PatchNumber i) { return i % 20 == 3 || (i >= 20 && i < 40); };
    std::erase_if(matrix.pairs, [&](const ExchangePair& pair) {
        const bool own = pair.i >= 60 && pair.j >= 60;  // the last chunk has no block of its own
        return own || is_alone(pair.i) || is_alone(pair.j);
    });
    const auto reflectance = test::random_reflectance(80, 0.2f, 0.95f, 3);
    auto emission = test::random_emission(80, 4);
    emission[3] = emission[25] = {5, 6, 7};
    const SolveResult result = run(matrix, reflectance, emission, 1e-6);
    EXPECT_TRUE(result.converged);
    EXPECT_LE(test::true_error(matrix, reflectance, emission, result.radiosity), result.error_bound);
    for (PatchNumber i = 0; i < 80; ++i)
        if (is_alone(i)) {
            EXPECT_EQ(result.radiosity[i], emission[i]);
            EXPECT_EQ(result.irradiance[i], (Channels{0, 0, 0}));
        }
}

TEST_P(SolverExtremes, PartsThatDoNotSeeEachOther) {
    // Patches 0 .. 39 and 40 .. 79; a chunk holds some of both. The second part may be white and sealed: no light gets there.
    Matrix matrix = random_matrix({.patches = 80, .chunk_patches = 30, .rooms = 2, .door = 0}, 8);
    for (const float second : {0.5f, 0.999f, 1.0f}) {
        auto reflectance = grey(80, 0.7f);
        std::fill(reflectance.begin() + 40, reflectance.end(), Rgb(second, second, second));
        std::vector<Channels> emission(80, {0, 0, 0});
        emission[1] = {5, 5, 5};
        const SolveResult result = run(matrix, reflectance, emission, 1e-6);
        EXPECT_TRUE(result.converged);
        for (std::size_t i = 40; i < 80; ++i) {
            EXPECT_EQ(result.radiosity[i], (Channels{0, 0, 0})) << i;
            EXPECT_EQ(result.irradiance[i], (Channels{0, 0, 0})) << i;
        }
        double power = 0, emitted = 5 * matrix.area_m2[1];
        for (std::size_t i = 0; i < 40; ++i) power += matrix.area_m2[i] * result.radiosity[i][0];
        EXPECT_NEAR(power * (1 - static_cast<double>(0.7f)), emitted, 1e-5 * emitted);
        if (second > 0.9f) continue;
        emission[50] = {0, 1, 1e9};  // both have light, of very different brightness
        const SolveResult both = run(matrix, reflectance, emission, 1e-6);
        EXPECT_TRUE(both.converged);
        EXPECT_LE(test::true_error(matrix, reflectance, emission, both.radiosity), both.error_bound);
    }
}

TEST_P(SolverExtremes, ChunkSizesAgree) {
    Matrix matrix = random_matrix({.patches = 256, .chunk_patches = 256, .closed = false, .rooms = 4}, 6);
    const auto reflectance = test::random_reflectance(256, 0.1f, 0.9f, 3);
    const auto emission = test::random_emission(256, 4);
    const SolveResult whole = run(matrix, reflectance, emission, 1e-8);
    for (const std::size_t chunk_patches : {1u, 7u, 64u, 200u}) {
        matrix.layout = even_layout(256, chunk_patches);
        const SolveResult result = run(matrix, reflectance, emission, 1e-8);
        EXPECT_TRUE(result.converged);
        for (std::size_t i = 0; i < 256; ++i)
            for (std::size_t c = 0; c < 3; ++c)
                EXPECT_NEAR(result.radiosity[i][c], whole.radiosity[i][c], 1e-6 * whole.radiosity[i][c]);
    }
}

/// As if the first `cached` blocks were in memory: they cost no byte of the disk.
class PartlyCached final : public BlockSource {
  public:
    PartlyCached(BlockSource& source, std::size_t cached) : source_(source), cached_(cached) {}
    const ChunkLayout& layout() const override { return source_.layout(); }
    std::span<const double> area_m2() const override { return source_.area_m2(); }
    std::span<const double> diagonal_m2() const override { return source_.diagonal_m2(); }
    std::span<const BlockInfo> blocks() const override { return source_.blocks(); }
    void load(std::size_t index, Block& out) override {
        source_.load(index, out);
        if (index >= cached_) bytes_ += blocks()[index].read_bytes;
    }
    std::uint64_t bytes_read() const override { return bytes_; }

  private:
    BlockSource& source_;
    std::size_t cached_;
    std::atomic<std::uint64_t> bytes_{0};
};

TEST_P(SolverExtremes, WhatIsCachedChangesNothing) {
    const Matrix matrix = random_matrix({.patches = 200, .chunk_patches = 20, .closed = false, .rooms = 5}, 6);
    const auto reflectance = test::random_reflectance(200, 0.1f, 0.9f, 3);
    const auto emission = test::random_emission(200, 4);
    MemoryBlocks blocks = matrix.blocks();
    for (const std::uint64_t max_reads : {100'000, 3}) {  // 3: not enough, and the limit must not depend on the cache either
        const SolveResult plain = run(blocks, reflectance, emission, max_reads == 3 ? 1e-12 : 1e-6, max_reads);
        for (const std::size_t cached : {blocks.blocks().size() / 2, blocks.blocks().size()}) {
            PartlyCached source(blocks, cached);
            const SolveResult other = run(source, reflectance, emission, max_reads == 3 ? 1e-12 : 1e-6, max_reads);
            EXPECT_EQ(plain.radiosity, other.radiosity);
            EXPECT_EQ(plain.irradiance, other.irradiance);
            EXPECT_EQ(plain.error_bound, other.error_bound);
            EXPECT_LT(other.reads, plain.reads);
        }
    }
}

TEST_P(SolverExtremes, BadNumbersAreRefused) {
    const Matrix matrix = random_matrix({.patches = 10, .chunk_patches = 5}, 5);
    const std::vector<Channels> light(10, {1, 1, 1});
    for (const double bad : {-1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
        auto emission = light;
        emission[2][1] = bad;
        EXPECT_THROW(run(matrix, grey(10, 0.5f), emission), Error) << bad;
        auto reflectance = grey(10, 0.5f);
        reflectance[4].y = static_cast<float>(bad);
        EXPECT_THROW(run(matrix, reflectance, light), Error) << bad;
    }
    auto reflectance = grey(10, 0.5f);
    reflectance[4].y = 1.5f;
    EXPECT_THROW(run(matrix, reflectance, light), Error);
    EXPECT_THROW(run(matrix, grey(9, 0.5f), light), Error);
}

INSTANTIATE_TEST_SUITE_P(All, SolverExtremes, test::all_solvers(), test::solver_test_name);

}  // namespace
}  // namespace luxel
