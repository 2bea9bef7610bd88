/// Small exchange matrices for tests, with their exact solutions from a dense factorisation.
#pragma once
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "baker/formfactors/memory_blocks.h"
#include "baker/solver/solver.h"

namespace luxel::test {

struct Matrix {
    ChunkLayout layout;
    std::vector<double> area_m2, diagonal_m2;
    std::vector<ExchangePair> pairs;

    [[nodiscard]] std::size_t count() const { return area_m2.size(); }
    [[nodiscard]] MemoryBlocks blocks() const { return {layout, area_m2, diagonal_m2, pairs}; }
    [[nodiscard]] Eigen::MatrixXd dense() const {
        const auto n = static_cast<Eigen::Index>(count());
        Eigen::MatrixXd g = Eigen::MatrixXd::Zero(n, n);
        for (Eigen::Index i = 0; i < n; ++i) g(i, i) = diagonal_m2[static_cast<std::size_t>(i)];
        for (const ExchangePair& pair : pairs)
            g(pair.i, pair.j) = g(pair.j, pair.i) = static_cast<double>(pair.area_m2);
        return g;
    }
    [[nodiscard]] std::vector<double> row_open_m2() const {
        std::vector<double> open = area_m2;
        for (std::size_t i = 0; i < count(); ++i) open[i] -= diagonal_m2[i];
        for (const ExchangePair& pair : pairs) {
            open[pair.i] -= static_cast<double>(pair.area_m2);
            open[pair.j] -= static_cast<double>(pair.area_m2);
        }
        return open;
    }
};

/// Chunks of `chunk_patches` patches, the last one shorter.
inline ChunkLayout even_layout(std::size_t patch_count, std::size_t chunk_patches) {
    ChunkLayout layout;
    for (std::size_t first = 0; first < patch_count; first += chunk_patches)
        layout.first_patch.push_back(static_cast<PatchNumber>(std::min(patch_count, first + chunk_patches)));
    return layout;
}

struct RandomMatrix {
    std::size_t patches = 50, chunk_patches = 16;
    double density = 0.5;     ///< share of pairs that see each other
    double area_decades = 0;  ///< areas are 10^-x m2, x uniform in [0, area_decades]
    bool closed = true;       ///< what a row lacks goes to the diagonal, else into the open
    std::size_t rooms = 1;    ///< rooms exchange `door` of what they exchange inside
    double door = 0.01;       ///< 0: they do not see each other
    double alone = 0;         ///< share of patches that see nothing
};

inline Matrix random_matrix(const RandomMatrix& want, unsigned seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> uniform(0, 1);
    Matrix matrix;
    matrix.layout = even_layout(want.patches, want.chunk_patches);
    double area_sum = 0;
    for (std::size_t i = 0; i < want.patches; ++i) {
        matrix.area_m2.push_back(std::pow(10.0, -want.area_decades * uniform(random)));
        area_sum += matrix.area_m2.back();
    }
    std::mt19937_64 other_random(seed + 1);
    std::vector<bool> alone(want.patches);
    for (std::size_t i = 0; i < want.patches; ++i) alone[i] = uniform(other_random) < want.alone;
    std::vector<double> row(want.patches, 0.0);
    for (std::size_t i = 0; i < want.patches; ++i)
        for (std::size_t j = i + 1; j < want.patches; ++j) {
            if (uniform(random) > want.density) continue;
            double g = matrix.area_m2[i] * matrix.area_m2[j] / area_sum * (0.1 + uniform(random));
            if (i * want.rooms / want.patches != j * want.rooms / want.patches) g *= want.door;
            if (g == 0 || alone[i] || alone[j]) continue;
            row[i] += g;
            row[j] += g;
            matrix.pairs.push_back({static_cast<PatchNumber>(i), static_cast<PatchNumber>(j), static_cast<float>(g)});
        }
    double longest = 1e-300;
    for (std::size_t i = 0; i < want.patches; ++i) longest = std::max(longest, row[i] / matrix.area_m2[i]);
    std::vector<double> sum(want.patches, 0.0);
    for (ExchangePair& pair : matrix.pairs) {
        pair.area_m2 = static_cast<float>(static_cast<double>(pair.area_m2) / longest);
        sum[pair.i] += static_cast<double>(pair.area_m2);
        sum[pair.j] += static_cast<double>(pair.area_m2);
    }
    for (std::size_t i = 0; i < want.patches; ++i)
        matrix.diagonal_m2.push_back(want.closed ? matrix.area_m2[i] - sum[i] : 0.0);
    return matrix;
}

inline SolveInput input_of(const std::vector<Rgb>& reflectance, const std::vector<Channels>& emission) {
    return {reflectance, emission};
}

/// B of one channel by LU factorisation.
inline Eigen::VectorXd exact_radiosity(const Matrix& matrix, const std::vector<Rgb>& reflectance,
                                       const std::vector<Channels>& emission, std::size_t channel) {
    const auto n = static_cast<Eigen::Index>(matrix.count());
    Eigen::MatrixXd k = matrix.dense();
    Eigen::VectorXd m(n);
    for (Eigen::Index i = 0; i < n; ++i) {
        const auto patch = static_cast<std::size_t>(i);
        k.row(i) *= static_cast<double>(reflectance[patch][static_cast<int>(channel)]) / matrix.area_m2[patch];
        m(i) = emission[patch][channel];
    }
    return (Eigen::MatrixXd::Identity(n, n) - k).partialPivLu().solve(m);
}

/// sum A |B - B*| / sum A B*, the worst channel.
inline double true_error(const Matrix& matrix, const std::vector<Rgb>& reflectance,
                         const std::vector<Channels>& emission, const std::vector<Channels>& radiosity) {
    double worst = 0;
    for (std::size_t c = 0; c < 3; ++c) {
        const Eigen::VectorXd exact = exact_radiosity(matrix, reflectance, emission, c);
        double error = 0, power = 0;
        for (std::size_t i = 0; i < matrix.count(); ++i) {
            const double b = exact(static_cast<Eigen::Index>(i));
            error += matrix.area_m2[i] * std::abs(radiosity[i][c] - b);
            power += matrix.area_m2[i] * b;
        }
        if (power > 0) worst = std::max(worst, error / power);
    }
    return worst;
}

inline std::vector<Rgb> random_reflectance(std::size_t count, float lowest, float highest, unsigned seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<float> uniform(lowest, highest);
    std::vector<Rgb> reflectance(count);
    for (Rgb& value : reflectance) value = {uniform(random), uniform(random), uniform(random)};
    return reflectance;
}

/// A tenth of the patches emits, at least one.
inline std::vector<Channels> random_emission(std::size_t count, unsigned seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> uniform(0, 1);
    std::vector<Channels> emission(count, {0, 0, 0});
    for (std::size_t i = 0; i < count; ++i)
        if (i == 0 || uniform(random) < 0.1) emission[i] = {uniform(random), 10 * uniform(random), uniform(random) / 7};
    return emission;
}

}  // namespace luxel::test
