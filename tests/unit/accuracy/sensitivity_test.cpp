// The cost of an error, against the same thing from a dense inverse; and that rays chosen by it are the best choice.
#include "baker/accuracy/sensitivity.h"

#include <gtest/gtest.h>

#include <numeric>

#include "baker/accuracy/ray_allocation.h"
#include "baker/core/sobol.h"
#include "tests/unit/solver/matrices.h"

namespace luxel::test {
namespace {

/// Two rooms, a lamp in the first, and everything that LightState needs.
class Light {
  public:
    explicit Light(float albedo, bool closed)
        : matrix(random_matrix({.patches = 24, .chunk_patches = 10, .closed = closed, .rooms = 2, .door = 0.03}, 7)), source(matrix.blocks()) {
        reflectance = random_reflectance(matrix.count(), albedo - 0.05f, albedo + 0.05f, 3);
        reflectance[5] = {0, 0, 0};
        const std::vector<Channels> emission = random_emission(matrix.count(), 4);
        const Eigen::MatrixXd g = matrix.dense();
        radiosity.resize(matrix.count());
        row_mean.resize(matrix.count());
        for (std::size_t c = 0; c < 3; ++c) {
            const Eigen::VectorXd b = exact_radiosity(matrix, reflectance, emission, c), arriving = g * b;
            for (std::size_t i = 0; i < matrix.count(); ++i) {
                radiosity[i][c] = b(static_cast<Eigen::Index>(i));
                row_mean[i][c] = arriving(static_cast<Eigen::Index>(i)) / matrix.area_m2[i];
            }
        }
        open = matrix.row_open_m2();
        mu.assign(matrix.count(), 1000);
        neighbourhood.resize(matrix.count());
        std::iota(neighbourhood.begin(), neighbourhood.end(), 0u);
        name(0);
    }

    /// Other ids: other random signs.
    void name(std::uint64_t seed) {
        ids.clear();
        for (std::size_t i = 0; i < matrix.count(); ++i) ids.push_back(mix(seed, i));
    }

    [[nodiscard]] LightState state() const { return {ids, matrix.area_m2, reflectance, radiosity, row_mean, mu, open, neighbourhood}; }

    /// sum_c sum_k A_k (dB_k / dG_ij)^2, closure making up for the error in both rows.
    [[nodiscard]] double exact_cost(PatchNumber i, PatchNumber j) const {
        double sum = 0;
        for (std::size_t c = 0; c < 3; ++c) {
            const Eigen::VectorXd change = response(c, i) * (radiosity[j][c] - row_mean[i][c]) + response(c, j) * (radiosity[i][c] - row_mean[j][c]);
            for (std::size_t k = 0; k < matrix.count(); ++k)
                sum += matrix.area_m2[k] * change(static_cast<Eigen::Index>(k)) * change(static_cast<Eigen::Index>(k));
        }
        return sum;
    }

    Matrix matrix;
    mutable MemoryBlocks source;
    std::vector<Rgb> reflectance;
    std::vector<Channels> radiosity, row_mean;
    std::vector<double> open, mu;
    std::vector<PatchId> ids;
    std::vector<std::uint32_t> neighbourhood;

  private:
    /// Radiosity of all patches for one lm more that arrives at patch i: column of (I - rho G / A)^-1 rho / A.
    [[nodiscard]] Eigen::VectorXd response(std::size_t c, PatchNumber i) const {
        std::vector<Channels> emission(matrix.count(), Channels{0, 0, 0});
        emission[i][c] = static_cast<double>(reflectance[i][static_cast<int>(c)]) / matrix.area_m2[i];
        return exact_radiosity(matrix, reflectance, emission, c);
    }
};

class SensitivityTest : public testing::TestWithParam<float> {};

TEST_P(SensitivityTest, IsTheSquaredErrorOfAllPatches) {
    Light light(GetParam(), true);
    struct Mean {
        double sum = 0, square = 0;
    };
    std::vector<Mean> found(light.matrix.pairs.size());
    constexpr int draws = 200;
    for (int draw = 0; draw < draws; ++draw) {
        light.name(static_cast<std::uint64_t>(draw) + 1);
        const LightState state = light.state();
        const Sensitivity sensitivity(light.source, state);
        for (std::size_t p = 0; p < found.size(); ++p) {
            const double cost = sensitivity.of_pair(light.matrix.pairs[p].i, light.matrix.pairs[p].j);
            found[p].sum += cost;
            found[p].square += cost * cost;
        }
    }
    for (std::size_t p = 0; p < found.size(); ++p) {
        const double mean = found[p].sum / draws, variance = found[p].square / draws - mean * mean;
        const double exact = light.exact_cost(light.matrix.pairs[p].i, light.matrix.pairs[p].j);
        // Some 150 pairs: five standard errors; and the solve behind it stops at 3 %.
        EXPECT_NEAR(mean, exact, 5 * std::sqrt(variance / draws) + 0.03 * exact) << "pair " << p;
    }
}

INSTANTIATE_TEST_SUITE_P(Albedos, SensitivityTest, testing::Values(0.3f, 0.9f));

/// Expected squared error for rays n_i: sum_pairs G s / (mu_i + mu_j) + sum open s / mu.
double expected_error(const Light& light, const std::vector<double>& rays) {
    const LightState state = light.state();
    const Sensitivity sensitivity(light.source, state);
    const auto mu = [&](PatchNumber i) { return rays[i] / light.matrix.area_m2[i]; };
    double sum = 0;
    for (const ExchangePair& pair : light.matrix.pairs)
        sum += static_cast<double>(pair.area_m2) * sensitivity.of_pair(pair.i, pair.j) / (mu(pair.i) + mu(pair.j));
    for (PatchNumber i = 0; i < light.matrix.count(); ++i) sum += light.open[i] * sensitivity.of_open(i) / mu(i);
    return sum;
}

TEST(RayAllocation, NoOtherChoiceHasLessError) {
    for (const bool closed : {true, false}) {
        const Light light(0.8f, closed);  // every patch has a neighbourhood of its own
        const double total = 256.0 * static_cast<double>(light.matrix.count());
        const std::vector<double> best = best_rays(light.source, light.state(), total, 1, 400);
        double sum = 0;
        for (const double rays : best) sum += rays;
        EXPECT_NEAR(sum, total, 1e-6 * total);
        const double least = expected_error(light, best);
        EXPECT_LT(least, expected_error(light, std::vector<double>(light.matrix.count(), 256.0)));
        // The error is convex in the rays: moving a tenth of one patch's rays to another is worse in every direction.
        for (std::size_t from = 0; from < best.size(); ++from)
            for (std::size_t to = 0; to < best.size(); ++to) {
                std::vector<double> other = best;
                const double moved = std::min(0.1 * best[from], best[from] - 1);
                other[from] -= moved;
                other[to] += moved;
                EXPECT_GE(expected_error(light, other), least * (1 - 1e-4)) << from << " to " << to;
            }
    }
}

/// Neighbours have one density, and among such choices none has less error.
TEST(RayAllocation, NeighboursShareADensity) {
    Light light(0.8f, false);
    const std::size_t count = light.matrix.count();
    const double total = 256.0 * static_cast<double>(count);
    for (std::size_t i = 0; i < count; ++i) light.neighbourhood[i] = static_cast<std::uint32_t>(i / 2);
    const std::vector<double> best = best_rays(light.source, light.state(), total, 1, 400);
    const double least = expected_error(light, best);
    const auto area = [&](std::size_t i) { return light.matrix.area_m2[i]; };
    for (std::size_t i = 0; i + 1 < count; i += 2) EXPECT_NEAR(best[i] / area(i), best[i + 1] / area(i + 1), 1e-9 * best[i] / area(i));
    for (std::size_t from = 0; from + 1 < count; from += 2)
        for (std::size_t to = 0; to + 1 < count; to += 2) {
            std::vector<double> other = best;
            const double both = best[from] + best[from + 1], moved = 0.1 * both;
            for (const std::size_t k : {0u, 1u}) {
                other[from + k] -= moved * best[from + k] / both;
                other[to + k] += moved * area(to + k) / (area(to) + area(to + 1));
            }
            EXPECT_GE(expected_error(light, other), least * (1 - 1e-4)) << from << " to " << to;
        }
}

}  // namespace
}  // namespace luxel::test
