/// Invariants of every solver over random scenes.
#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <cstdio>

#include "baker/core/parallel.h"
#include "baker/solver/energy_audit.h"
#include "baker/solver/solve.h"
#include "tests/unit/solver/matrices.h"

namespace luxel {
namespace {

struct Scene {
    test::Matrix matrix;
    std::vector<Rgb> reflectance;
    std::vector<Channels> emission;
    SolverKind solver = SolverKind::shoot;
};

/// Any density from nothing to everything, areas over up to 12 decades, open or closed, rooms that see each other little or
/// not at all, patches that see nothing, black patches, and now and then one that reflects 0.99 among darker ones.
Scene any_scene(float highest_reflectance) {
    const auto seed = *rc::gen::inRange(0u, 1000000u);
    test::RandomMatrix want;
    want.patches = *rc::gen::inRange<std::size_t>(1, 70);
    want.chunk_patches = *rc::gen::inRange<std::size_t>(1, 40);
    want.density = *rc::gen::inRange(0, 101) / 100.0;
    want.area_decades = *rc::gen::inRange(0, 13);
    want.closed = *rc::gen::arbitrary<bool>();
    want.rooms = *rc::gen::inRange<std::size_t>(1, 5);
    want.door = *rc::gen::element(0.3, 0.01, 1e-4, 0.0);
    want.alone = *rc::gen::element(0.0, 0.0, 0.2);
    Scene scene{test::random_matrix(want, seed), {}, test::random_emission(want.patches, seed + 1),
                *rc::gen::element(SolverKind::shoot, SolverKind::shoot_patch, SolverKind::gather, SolverKind::jacobi, SolverKind::cg)};
    const float highest = highest_reflectance * static_cast<float>(*rc::gen::inRange(0, 101)) / 100.0f;
    scene.reflectance = test::random_reflectance(want.patches, 0.0f, highest, seed + 2);
    for (std::size_t i = 0; i < want.patches; i += 7) scene.reflectance[i] = {0, 0, 0};
    if (*rc::gen::arbitrary<bool>()) scene.reflectance.back() = Rgb(0.99f, 0.99f, 0.99f) * highest_reflectance;
    return scene;
}

SolveResult solved(const Scene& scene, double tolerance) {
    MemoryBlocks blocks = scene.matrix.blocks();
    SolveOptions options;
    options.tolerance = tolerance;
    return solve(scene.solver, blocks, {scene.reflectance, scene.emission}, options);
}

/// sum A |H - H*| / sum A B*, the worst channel: the bound covers irradiance too.
double irradiance_error(const Scene& scene, const SolveResult& result) {
    const Eigen::MatrixXd g = scene.matrix.dense();
    double worst = 0;
    for (std::size_t c = 0; c < 3; ++c) {
        const Eigen::VectorXd exact = test::exact_radiosity(scene.matrix, scene.reflectance, scene.emission, c);
        const Eigen::VectorXd received = g * exact;
        double error = 0, power = 0;
        for (std::size_t i = 0; i < scene.matrix.count(); ++i) {
            error +=
                std::abs(scene.matrix.area_m2[i] * result.irradiance[i][c] - received(static_cast<Eigen::Index>(i)));
            power += scene.matrix.area_m2[i] * exact(static_cast<Eigen::Index>(i));
        }
        if (power > 0) worst = std::max(worst, error / power);
    }
    return worst;
}

double largest_ratio = 0, ratio_sum = 0;
std::size_t ratio_count = 0;

RC_GTEST_PROP(SolverProperty, ConvergesAndItsBoundIsNeverBelowTheTrueError, ()) {
    const Scene scene = any_scene(0.99f);
    const double tolerance = *rc::gen::element(0.1, 1e-3, 1e-6);
    const SolveResult result = solved(scene, tolerance);
    const double error = test::true_error(scene.matrix, scene.reflectance, scene.emission, result.radiosity);
    RC_ASSERT(result.converged);
    RC_ASSERT(result.error_bound <= tolerance);
    RC_ASSERT(error <= result.error_bound + 1e-12);
    for (std::size_t i = 0; i < scene.matrix.count(); ++i)
        for (std::size_t c = 0; c < 3; ++c) {
            RC_ASSERT(result.radiosity[i][c] >= 0);
            RC_ASSERT(result.irradiance[i][c] >= 0);
            RC_ASSERT(std::abs(result.radiosity[i][c] - scene.emission[i][c] -
                               static_cast<double>(scene.reflectance[i][static_cast<int>(c)]) *
                                   result.irradiance[i][c]) <= 1e-6 * (1e-9 + result.radiosity[i][c]));
        }
    if (result.reads == 0) return;  // nothing reflects: no factor was read, irradiance is not known
    const double irradiance = irradiance_error(scene, result);
    // 1e-7: a diagonal that is negative by the rounding of floats is kept from making irradiance negative.
    RC_ASSERT(irradiance <= result.error_bound + 1e-7);
    if (irradiance > 1e-13 && result.error_bound > 0) {
        largest_ratio = std::max(largest_ratio, result.error_bound / irradiance);
        ratio_sum += std::log(result.error_bound / irradiance);
        ++ratio_count;
    }
}

/// A figure for the reader, not a check: printed when all tests have run.
class TightnessPrinter : public testing::Environment {
  public:
    void TearDown() override {
        if (ratio_count > 0)
            std::printf("bound / true error of irradiance over %zu scenes: geometric mean %.2f, largest %.1f\n",
                        ratio_count, std::exp(ratio_sum / static_cast<double>(ratio_count)), largest_ratio);
    }
};
[[maybe_unused]] const testing::Environment* const printer = testing::AddGlobalTestEnvironment(new TightnessPrinter);

RC_GTEST_PROP(SolverProperty, EnergyBalances, ()) {
    const Scene scene = any_scene(0.99f);
    const SolveResult result = solved(scene, 1e-6);
    const EnergyAudit audit =
        audit_energy(scene.matrix.area_m2, scene.matrix.row_open_m2(), {scene.reflectance, scene.emission}, result);
    RC_ASSERT(audit.imbalance <= 1e-4);
}

RC_GTEST_PROP(SolverProperty, WhiteScenesEndWhereLightCanLeave, ()) {
    Scene scene = any_scene(1.0f);
    for (Rgb& reflectance : scene.reflectance) reflectance = {1, 1, 1};
    // Every patch loses a little. A patch that is nearly alone keeps most of its own light then, which no aggregate of
    // chunks describes: shots alone may need more reads than allowed, but what is said about the error must hold.
    for (std::size_t i = 0; i < scene.matrix.count(); ++i)
        scene.matrix.diagonal_m2[i] -= 0.01 * scene.matrix.area_m2[i];
    const SolveResult result = solved(scene, 1e-3);
    RC_CLASSIFY(!result.converged, "stopped at max_reads");
    RC_ASSERT(test::true_error(scene.matrix, scene.reflectance, scene.emission, result.radiosity) <=
              result.error_bound + 1e-12);
}

RC_GTEST_PROP(SolverProperty, ThreadsDoNotChangeABit, ()) {
    const Scene scene = any_scene(0.99f);
    std::vector<SolveResult> results;
    for (const unsigned threads : {1u, 3u}) {
        const ThreadLimit limit(threads);
        results.push_back(solved(scene, 1e-4));
    }
    RC_ASSERT(results[0].radiosity == results[1].radiosity);
    RC_ASSERT(results[0].error_bound == results[1].error_bound);
}

}  // namespace
}  // namespace luxel
