#include "baker/solver/shoot.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <limits>

#include "baker/core/parallel.h"
#include "baker/solver/history.h"
#include "formats/base/error.h"
#include "tests/unit/solver/matrices.h"

namespace luxel {
namespace {

using test::even_layout;
using test::Matrix;
using test::random_matrix;
using test::RandomMatrix;

SolveResult shoot(const Matrix& matrix, const std::vector<Rgb>& reflectance, const std::vector<Channels>& emission,
                  double tolerance = 1e-3) {
    MemoryBlocks blocks = matrix.blocks();
    SolveOptions options;
    options.tolerance = tolerance;
    return solve_by_shooting(blocks, {reflectance, emission}, options);
}

std::vector<Rgb> grey(std::size_t count, float value) { return std::vector<Rgb>(count, Rgb(value, value, value)); }

TEST(Shoot, FurnaceIsEmissionOverOneMinusReflectance) {
    const Matrix matrix = random_matrix({.patches = 300, .chunk_patches = 64}, 1);
    const std::vector<Channels> emission(matrix.count(), {1, 2, 3});
    for (const double rho : {0.0, 0.5, 0.9, 0.99}) {
        const auto reflectance = grey(matrix.count(), static_cast<float>(rho));
        const SolveResult result = shoot(matrix, reflectance, emission, 1e-8);
        ASSERT_TRUE(result.converged);
        const double factor = 1 / (1 - static_cast<double>(reflectance[0].x));
        for (const Channels& b : result.radiosity)
            for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(b[c] / (emission[0][c] * factor), 1.0, 1e-6);
        std::printf("furnace rho %.2f: bound %.2g, %.1f reads\n", rho, result.error_bound, result.reads);
    }
}

TEST(Shoot, AgreesWithDenseSolutionWithinItsBound) {
    for (const float highest : {0.5f, 0.8f, 0.95f, 0.99f, 1.0f})
        for (const bool closed : {false, true}) {
            RandomMatrix want{.patches = 400, .chunk_patches = 50, .closed = closed, .rooms = 4};
            const Matrix matrix = random_matrix(want, 7);
            const auto reflectance = test::random_reflectance(matrix.count(), highest * 0.6f, highest, 3);
            const auto emission = test::random_emission(matrix.count(), 4);
            const SolveResult result = shoot(matrix, reflectance, emission);
            const double error = test::true_error(matrix, reflectance, emission, result.radiosity);
            EXPECT_TRUE(result.converged);
            EXPECT_LE(result.error_bound, 1e-3);
            EXPECT_LE(error, result.error_bound);
            std::printf("rho <= %.2f %s: %.2f reads, bound %.2g, true %.2g, ratio %.1f\n", static_cast<double>(highest),
                        closed ? "closed" : "open", result.reads, result.error_bound, error,
                        result.error_bound / error);
        }
}

TEST(Shoot, IrradianceAndRadiosityAgree) {
    const Matrix matrix = random_matrix({.patches = 200, .chunk_patches = 30, .closed = false}, 2);
    auto reflectance = test::random_reflectance(matrix.count(), 0.2f, 0.9f, 3);
    reflectance[5] = {0, 0, 0};
    const auto emission = test::random_emission(matrix.count(), 4);
    const SolveResult result = shoot(matrix, reflectance, emission, 1e-9);
    const Eigen::MatrixXd g = matrix.dense();
    const Eigen::VectorXd b = test::exact_radiosity(matrix, reflectance, emission, 1);
    for (std::size_t i = 0; i < matrix.count(); ++i) {
        const double h = g.row(static_cast<Eigen::Index>(i)).dot(b) / matrix.area_m2[i];
        EXPECT_NEAR(result.irradiance[i][1], h, 1e-6 * h);
        EXPECT_NEAR(result.radiosity[i][1],
                    emission[i][1] + static_cast<double>(reflectance[i].y) * result.irradiance[i][1], 1e-9);
    }
}

TEST(Shoot, WhiteOpenSceneConverges) {
    for (const std::size_t rooms : {std::size_t{1}, std::size_t{16}}) {
        Matrix matrix = random_matrix({.patches = 320, .chunk_patches = 20, .rooms = rooms, .door = 1e-3}, 5);
        // Closed but for a few patches of the last room.
        for (std::size_t i = 310; i < 320; ++i) matrix.diagonal_m2[i] = -0.02 * matrix.area_m2[i];
        const auto reflectance = grey(matrix.count(), 1.0f);
        std::vector<Channels> emission(matrix.count(), {0, 0, 0});
        emission[0] = {1, 1, 1};
        const SolveResult result = shoot(matrix, reflectance, emission);
        const double error = test::true_error(matrix, reflectance, emission, result.radiosity);
        EXPECT_TRUE(result.converged);
        EXPECT_LE(error, result.error_bound);
        std::printf("white, %zu rooms, one opening: %.1f reads, bound %.2g, true %.2g\n", rooms, result.reads,
                    result.error_bound, error);
    }
}

TEST(Shoot, LightThatNeverEndsIsAnError) {
    const Matrix matrix = random_matrix({.patches = 60, .chunk_patches = 20}, 5);
    std::vector<Channels> emission(matrix.count(), {0, 0, 0});
    emission[3] = {0, 1, 0};
    try {
        shoot(matrix, grey(matrix.count(), 1.0f), emission);
        FAIL() << "no error";
    } catch (const Error& error) {
        EXPECT_EQ(error.code, ErrorCode::bad_input);
        EXPECT_NE(error.what_text.find("the light never ends"), std::string::npos);
    }
    // One patch that sees only itself.
    const Matrix alone{even_layout(1, 1), {2.0}, {2.0}, {}};
    EXPECT_THROW(shoot(alone, grey(1, 1.0f), {{1, 1, 1}}), Error);
}

TEST(Shoot, SealedWhiteRoomWithoutLampDoesNoHarm) {
    // Two scenes that do not see each other: patches 0..39 lit and grey, 40..79 white and dark.
    Matrix matrix = random_matrix({.patches = 80, .chunk_patches = 30, .rooms = 2, .door = 1e-30}, 8);
    std::erase_if(matrix.pairs, [](const ExchangePair& pair) { return (pair.i < 40) != (pair.j < 40); });
    auto reflectance = grey(80, 0.7f);
    for (std::size_t i = 40; i < 80; ++i) reflectance[i] = {1, 1, 1};
    std::vector<Channels> emission(80, {0, 0, 0});
    emission[1] = {5, 5, 5};
    const SolveResult result = shoot(matrix, reflectance, emission);
    EXPECT_TRUE(result.converged);
    for (std::size_t i = 0; i < 80; ++i) EXPECT_EQ(result.radiosity[i][0] > 0, i < 40);
}

TEST(Shoot, LongRowsDoNotBreakTheBound) {
    // Rows 2 % longer than their area, reflectance 0.9: still below 1, but not what reflectances alone would allow.
    Matrix matrix = random_matrix({.patches = 120, .chunk_patches = 40}, 9);
    for (std::size_t i = 0; i < matrix.count(); ++i) matrix.diagonal_m2[i] += 0.02 * matrix.area_m2[i];
    const auto emission = test::random_emission(matrix.count(), 4);
    for (const float rho : {0.9f, 0.975f}) {
        const auto reflectance = grey(matrix.count(), rho);
        const SolveResult result = shoot(matrix, reflectance, emission);
        EXPECT_TRUE(result.converged);
        EXPECT_LE(test::true_error(matrix, reflectance, emission, result.radiosity), result.error_bound);
    }
    // Rounding: rows too long by one part in ten million, nearly white.
    Matrix rounded = random_matrix({.patches = 120, .chunk_patches = 40}, 10);
    for (std::size_t i = 0; i < rounded.count(); ++i) rounded.diagonal_m2[i] += 1e-7 * rounded.area_m2[i];
    const auto reflectance = grey(rounded.count(), 0.999f);
    const SolveResult result = shoot(rounded, reflectance, emission);
    EXPECT_TRUE(result.converged);
    EXPECT_LE(test::true_error(rounded, reflectance, emission, result.radiosity), result.error_bound);
}

TEST(Shoot, NegativeDiagonalIsExact) {
    Matrix matrix = random_matrix({.patches = 90, .chunk_patches = 30}, 11);
    for (std::size_t i = 0; i < matrix.count(); i += 2) matrix.diagonal_m2[i] = -0.05 * matrix.area_m2[i];
    const auto reflectance = test::random_reflectance(matrix.count(), 0.3f, 0.99f, 3);
    const auto emission = test::random_emission(matrix.count(), 4);
    const SolveResult result = shoot(matrix, reflectance, emission, 1e-9);
    EXPECT_LE(test::true_error(matrix, reflectance, emission, result.radiosity), 1e-9);
}

TEST(Shoot, TheModelSavesReadsWhereLightWanders) {
    // Eight rooms, one lamp, nearly white: shots alone would have to send the light to and fro some fifty times.
    const Matrix matrix = random_matrix({.patches = 400, .chunk_patches = 50, .density = 0.8, .rooms = 8, .door = 0.02}, 4);
    const std::vector<Rgb> reflectance(400, Rgb(0.98f, 0.98f, 0.98f));
    std::vector<Channels> emission(400, {0, 0, 0});
    emission[20] = {1, 2, 3};
    MemoryBlocks blocks = matrix.blocks();
    const SolveResult result = solve_by_shooting(blocks, {reflectance, emission}, {});
    EXPECT_TRUE(result.converged);
    EXPECT_LE(test::true_error(matrix, reflectance, emission, result.radiosity), result.error_bound);
    EXPECT_LE(result.reads, 8);
    std::printf("eight rooms at 0.98: bound %.1e after %.1f reads\n", result.error_bound, result.reads);
}

TEST(Shoot, HistoryEndsWithTheResult) {
    const Matrix matrix = random_matrix({.patches = 200, .chunk_patches = 10, .density = 0.3, .closed = false}, 6);
    const auto reflectance = test::random_reflectance(200, 0.8f, 0.97f, 3);
    const auto emission = test::random_emission(200, 4);
    MemoryBlocks blocks = matrix.blocks();
    SolveOptions options;
    std::size_t calls = 0;
    options.step = [&](const SolveView&) { return ++calls > 0; };
    const SolveResult result = solve_by_shooting(blocks, {reflectance, emission}, options);
    EXPECT_EQ(calls, result.history.size());
    EXPECT_EQ(result.history.front().bytes_read, 0u);
    EXPECT_EQ(result.history.back().error_bound, result.error_bound);
    EXPECT_EQ(result.history.back().bytes_read, blocks.bytes_read());
    for (std::size_t i = 1; i < result.history.size(); ++i)
        EXPECT_GE(result.history[i].bytes_read, result.history[i - 1].bytes_read);
}

TEST(History, KeepsFirstAndLastAndAtMostAThousand) {
    for (const std::size_t steps : {1u, 999u, 1000u, 1001u, 2500u, 100000u}) {
        History history;
        for (std::size_t i = 0; i < steps; ++i) history.add({i, 1.0 / static_cast<double>(i + 1)});
        const std::vector<SolveStep> kept = history.steps();
        EXPECT_LE(kept.size(), 1000u);
        EXPECT_GE(kept.size(), std::min<std::size_t>(steps, 499));
        EXPECT_EQ(kept.front().bytes_read, 0u);
        EXPECT_EQ(kept.back().bytes_read, steps - 1);
        for (std::size_t i = 1; i < kept.size(); ++i) EXPECT_GT(kept[i].bytes_read, kept[i - 1].bytes_read);
    }
}

TEST(Shoot, BadInputIsNamed) {
    const Matrix matrix = random_matrix({.patches = 10, .chunk_patches = 5}, 5);
    const std::vector<Channels> light(10, {1, 1, 1});
    auto reflectance = grey(10, 0.5f);
    reflectance[4].y = std::numeric_limits<float>::quiet_NaN();
    EXPECT_THROW(shoot(matrix, reflectance, light), Error);
    auto emission = light;
    emission[2][1] = -1;
    EXPECT_THROW(shoot(matrix, grey(10, 0.5f), emission), Error);
    EXPECT_THROW(shoot(matrix, grey(9, 0.5f), light), Error);
}

}  // namespace
}  // namespace luxel
