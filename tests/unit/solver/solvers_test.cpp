/// What every solver must do, for all of them.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "baker/core/parallel.h"
#include "baker/solver/solve.h"
#include "formats/base/error.h"
#include "tests/support/solver_kinds.h"
#include "tests/unit/solver/matrices.h"

namespace luxel {
namespace {

using test::Matrix;
using test::random_matrix;

class Solvers : public testing::TestWithParam<SolverKind> {
  protected:
    /// Shooting patch by patch reads a chunk's row for each of them.
    static constexpr std::uint64_t enough = 1'000'000;
    static SolveResult run(const Matrix& matrix, const std::vector<Rgb>& reflectance,
                           const std::vector<Channels>& emission, double tolerance = 1e-3,
                           std::uint64_t max_reads = enough) {
        MemoryBlocks blocks = matrix.blocks();
        SolveOptions options;
        options.tolerance = tolerance;
        options.max_reads = max_reads;
        return solve(GetParam(), blocks, {reflectance, emission}, options);
    }
    static std::vector<Rgb> grey(std::size_t count, float value) {
        return std::vector<Rgb>(count, Rgb(value, value, value));
    }
};

TEST_P(Solvers, FurnaceIsEmissionOverOneMinusReflectance) {
    const Matrix matrix = random_matrix({.patches = 300, .chunk_patches = 64}, 1);
    const std::vector<Channels> emission(matrix.count(), {1, 2, 3});
    for (const float rho : {0.0f, 0.5f, 0.9f}) {
        const SolveResult result = run(matrix, grey(matrix.count(), rho), emission, 1e-6);
        ASSERT_TRUE(result.converged) << rho;
        for (const Channels& b : result.radiosity)
            for (std::size_t c = 0; c < 3; ++c)
                EXPECT_NEAR(b[c] * (1 - static_cast<double>(rho)) / emission[0][c], 1.0, 1e-5);
        std::printf("%s: furnace rho %.2f: bound %.2g, %.1f reads\n", result.solver.c_str(), static_cast<double>(rho),
                    result.error_bound, result.reads);
    }
}

TEST_P(Solvers, AgreeWithTheDenseSolutionWithinTheirBound) {
    for (const float highest : {0.5f, 0.8f, 0.95f})
        for (const bool closed : {false, true}) {
            const Matrix matrix = random_matrix({.patches = 400, .chunk_patches = 50, .closed = closed, .rooms = 4}, 7);
            const auto reflectance = test::random_reflectance(matrix.count(), highest * 0.6f, highest, 3);
            const auto emission = test::random_emission(matrix.count(), 4);
            const SolveResult result = run(matrix, reflectance, emission);
            const double error = test::true_error(matrix, reflectance, emission, result.radiosity);
            ASSERT_TRUE(result.converged);
            EXPECT_LE(error, result.error_bound);
            std::printf("%s: highest %.2f, %s: bound %.2e, true %.2e, %.1f reads\n", result.solver.c_str(),
                        static_cast<double>(highest), closed ? "closed" : "open", result.error_bound, error,
                        result.reads);
        }
}

TEST_P(Solvers, TheBoundHoldsWhereverTheyStop) {
    const Matrix matrix = random_matrix({.patches = 300, .chunk_patches = 40, .rooms = 3, .door = 0.05}, 9);
    const auto reflectance = test::random_reflectance(matrix.count(), 0.2f, 0.98f, 3);
    const auto emission = test::random_emission(matrix.count(), 4);
    for (std::uint64_t reads = 1; reads < 12; ++reads) {
        const SolveResult result = run(matrix, reflectance, emission, 1e-9, reads);
        EXPECT_LE(test::true_error(matrix, reflectance, emission, result.radiosity), result.error_bound) << reads;
        EXPECT_LE(result.reads, static_cast<double>(reads));
    }
}

TEST_P(Solvers, BrightnessHasNoScale) {
    const Matrix matrix = random_matrix({.patches = 60, .chunk_patches = 20}, 2);
    const auto reflectance = test::random_reflectance(matrix.count(), 0.3f, 0.7f, 3);
    auto emission = test::random_emission(matrix.count(), 4);
    const SolveResult one = run(matrix, reflectance, emission);
    for (const double factor : {0x1p-100, 0x1p+100}) {
        auto scaled = emission;
        for (Channels& m : scaled)
            for (double& value : m) value *= factor;
        const SolveResult other = run(matrix, reflectance, scaled);
        for (std::size_t i = 0; i < matrix.count(); ++i)
            for (std::size_t c = 0; c < 3; ++c) EXPECT_EQ(other.radiosity[i][c], one.radiosity[i][c] * factor);
    }
}

TEST_P(Solvers, NothingToDoCostsNoRead) {
    const Matrix matrix = random_matrix({.patches = 30, .chunk_patches = 10}, 3);
    const auto emission = test::random_emission(matrix.count(), 4);
    const SolveResult black = run(matrix, grey(matrix.count(), 0), emission);
    EXPECT_EQ(black.reads, 0);
    EXPECT_EQ(black.radiosity, emission);
    const SolveResult dark = run(matrix, grey(matrix.count(), 0.5f), std::vector<Channels>(matrix.count(), {0, 0, 0}));
    EXPECT_TRUE(dark.converged);
    EXPECT_EQ(dark.reads, 0);
}

TEST_P(Solvers, RefuseLightThatNeverEnds) {
    const Matrix matrix = random_matrix({.patches = 30, .chunk_patches = 10}, 3);
    EXPECT_THROW(run(matrix, grey(matrix.count(), 1), test::random_emission(matrix.count(), 4)), Error);
}

/// Rows longer than their area: still below 1 with these reflectances, but not what reflectances alone would allow.
TEST_P(Solvers, TheBoundHoldsForRowsThatAreTooLong) {
    Matrix matrix = random_matrix({.patches = 120, .chunk_patches = 30}, 4);
    for (std::size_t i = 0; i < matrix.count(); ++i) matrix.diagonal_m2[i] += 0.05 * matrix.area_m2[i];
    const auto reflectance = grey(matrix.count(), 0.94f);
    const auto emission = test::random_emission(matrix.count(), 4);
    const SolveResult result = run(matrix, reflectance, emission);
    EXPECT_TRUE(result.converged);
    EXPECT_LE(test::true_error(matrix, reflectance, emission, result.radiosity), result.error_bound);
}

/// Many small chunks, and few whose own blocks are cut among the threads.
TEST_P(Solvers, ThreadsDoNotChangeABit) {
    for (const test::RandomMatrix& want :
         {test::RandomMatrix{.patches = 500, .chunk_patches = 30, .rooms = 3},
          test::RandomMatrix{.patches = 900, .chunk_patches = 450, .density = 0.9, .closed = false}})
        for (const float highest : {0.9f, 1.0f}) {
            if (want.closed && highest == 1) continue;
            const Matrix matrix = random_matrix(want, 6);
            const auto reflectance = test::random_reflectance(matrix.count(), 0.1f, highest, 3);
            const auto emission = test::random_emission(matrix.count(), 4);
            std::vector<SolveResult> results;
            for (const unsigned threads : {1u, 2u, 5u}) {
                const ThreadLimit limit(threads);
                results.push_back(run(matrix, reflectance, emission));
            }
            for (const SolveResult& result : results) {
                EXPECT_EQ(result.radiosity, results[0].radiosity);
                EXPECT_EQ(result.irradiance, results[0].irradiance);
                EXPECT_EQ(result.unshot, results[0].unshot);
                EXPECT_EQ(result.error_bound, results[0].error_bound);
            }
        }
}

TEST_P(Solvers, StopWhenToldAndGoOnToTheSameBits) {
    const Matrix matrix = random_matrix({.patches = 300, .chunk_patches = 30, .rooms = 3, .door = 0.05}, 9);
    const auto reflectance = test::random_reflectance(matrix.count(), 0.5f, 0.97f, 3);
    const auto emission = test::random_emission(matrix.count(), 4);
    const SolveResult whole = run(matrix, reflectance, emission, 1e-5);
    ASSERT_TRUE(whole.converged);
    for (const std::size_t stop_at : {std::size_t{1}, std::size_t{2}, std::size_t{5}, whole.history.size() / 2}) {
        SolveState state;
        SolveOptions options;
        options.tolerance = 1e-5;
        options.max_reads = enough;
        std::size_t steps = 0;
        std::vector<Channels> seen;
        options.step = [&](const SolveView& view) {
            if (++steps < stop_at) return true;
            state = view.state();
            seen = view.irradiance(false);
            return false;
        };
        MemoryBlocks first = matrix.blocks();
        const SolveResult stopped = solve(GetParam(), first, {reflectance, emission}, options);
        EXPECT_EQ(steps, stop_at);
        EXPECT_FALSE(stopped.converged);
        EXPECT_EQ(stopped.irradiance, seen);
        EXPECT_LE(test::true_error(matrix, reflectance, emission, stopped.radiosity), stopped.error_bound);
        options.step = {};
        options.resume = &state;
        MemoryBlocks second = matrix.blocks();
        const SolveResult continued = solve(GetParam(), second, {reflectance, emission}, options);
        EXPECT_TRUE(continued.converged);
        EXPECT_EQ(continued.radiosity, whole.radiosity) << "stopped after " << stop_at;
        EXPECT_EQ(continued.error_bound, whole.error_bound);
        EXPECT_LT(second.bytes_read(), whole.history.back().bytes_read + first.total_bytes());
    }
}

TEST_P(Solvers, AmbientLightIsAllThatIsStillToComeInAClosedRoom) {
    // Before any light has been received and ever after: what is absorbed in the end is what is emitted.
    const Matrix matrix = random_matrix({.patches = 100, .chunk_patches = 20}, 3);
    const auto reflectance = grey(matrix.count(), 0.75f);
    const std::vector<Channels> emission(matrix.count(), {1, 2, 3});
    SolveOptions options;
    std::size_t looks = 0;
    options.step = [&](const SolveView& view) {
        ++looks;
        const std::vector<Channels> irradiance = view.irradiance(true);
        for (std::size_t c = 0; c < 3; ++c) {
            double absorbed = 0, emitted = 0;
            for (std::size_t i = 0; i < irradiance.size(); ++i) {
                absorbed += matrix.area_m2[i] * 0.25 * irradiance[i][c];
                emitted += matrix.area_m2[i] * emission[i][c];
            }
            // What a strip gathers in the middle of a sweep is partly of this sweep, partly of the last: between its first
            // and its last step the ambient light of gathering is a guess also here.
            const bool gathers = GetParam() == SolverKind::gather;
            if (gathers && looks > 1 && view.error_bound() > 1e-3) continue;
            EXPECT_NEAR(absorbed, emitted, (gathers ? 1e-3 : 1e-5) * emitted) << "step " << looks;
        }
        return true;
    };
    MemoryBlocks blocks = matrix.blocks();
    (void)solve(GetParam(), blocks, {reflectance, emission}, options);
    EXPECT_GT(looks, 1u);
}

INSTANTIATE_TEST_SUITE_P(All, Solvers, test::all_solvers(), test::solver_test_name);

}  // namespace
}  // namespace luxel
