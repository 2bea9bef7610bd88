#include "baker/solver/adjoint.h"

#include <gtest/gtest.h>

#include <cstdio>

#include "baker/solver/certificate.h"
#include "tests/unit/solver/matrices.h"

namespace luxel {
namespace {

/// T_ij = G_ij rho'_j / A_i without the diagonal, as adjoint.h defines it.
Eigen::MatrixXd adjoint_matrix(const test::Matrix& matrix, const Transport& transport, std::size_t channel) {
    Eigen::MatrixXd t = matrix.dense();
    for (Eigen::Index i = 0; i < t.rows(); ++i)
        for (Eigen::Index j = 0; j < t.cols(); ++j)
            t(i, j) *= i == j ? 0.0
                              : transport.scaled_reflectance(static_cast<PatchNumber>(j))[channel] /
                                    matrix.area_m2[static_cast<std::size_t>(i)];
    return t;
}

/// Smallest w - T w, and largest w / w*.
struct Quality {
    double margin = 1e300, excess = 0;
};

template <class Weight>
Quality quality(const test::Matrix& matrix, const Transport& transport, const Weight& weight) {
    Quality result;
    const auto n = static_cast<Eigen::Index>(matrix.count());
    for (std::size_t c = 0; c < 3; ++c) {
        const Eigen::MatrixXd t = adjoint_matrix(matrix, transport, c);
        Eigen::VectorXd w(n);
        for (Eigen::Index i = 0; i < n; ++i) w(i) = weight(static_cast<PatchNumber>(i))[c];
        const Eigen::VectorXd exact =
            (Eigen::MatrixXd::Identity(n, n) - t).partialPivLu().solve(Eigen::VectorXd::Ones(n));
        result.margin = std::min(result.margin, (w - t * w).minCoeff());
        result.excess = std::max(result.excess, (w.array() / exact.array()).maxCoeff());
    }
    return result;
}

TEST(Adjoint, StartFromReflectancesIsACertificate) {
    test::Matrix matrix = test::random_matrix({.patches = 120, .chunk_patches = 30}, 3);
    for (std::size_t i = 0; i < matrix.count(); i += 3) matrix.diagonal_m2[i] = -0.01 * matrix.area_m2[i];
    const auto reflectance = test::random_reflectance(matrix.count(), 0.2f, 0.95f, 3);
    MemoryBlocks blocks = matrix.blocks();
    Transport transport(blocks, reflectance, {true, true, true});
    const std::vector<std::uint8_t> emits(matrix.count(), 1);
    const Adjoint adjoint = Adjoint::certify(transport, emits);
    EXPECT_EQ(blocks.bytes_read(), 0u);
    EXPECT_GE(quality(matrix, transport, [&](PatchNumber i) { return adjoint.weight(i); }).margin, 1.0);
}

TEST(Adjoint, LoweringAChunkKeepsTheCertificateAndTightensIt) {
    const test::Matrix matrix = test::random_matrix({.patches = 120, .chunk_patches = 60, .rooms = 2}, 3);
    const auto reflectance = test::random_reflectance(matrix.count(), 0.2f, 0.97f, 3);
    MemoryBlocks blocks = matrix.blocks();
    Transport transport(blocks, reflectance, {true, true, true});
    const std::vector<std::uint8_t> emits(matrix.count(), 1);
    Adjoint adjoint = Adjoint::certify(transport, emits);
    const auto weight = [&](PatchNumber i) { return adjoint.weight(i); };
    double excess = quality(matrix, transport, weight).excess;
    for (ChunkNumber chunk : {0u, 1u, 0u, 1u}) {
        const std::shared_ptr<const Block> diagonal = transport.load_diagonal(chunk);
        ASSERT_TRUE(diagonal);
        const ChunkSystem system(transport, chunk, diagonal.get());
        std::vector<Lanes> gathered(system.size()), unused(system.size());
        std::vector<Lanes> source(60), nothing(60);
        for (PatchNumber i = 0; i < 60; ++i) {
            const PatchNumber patch = transport.first(1 - chunk) + i;
            for (std::size_t c = 0; c < 3; ++c)
                source[i].v[c] = transport.scaled_reflectance(patch)[c] * adjoint.weight(patch)[c];
            source[i].v[3] = 1;
        }
        const std::shared_ptr<const Block> block = transport.load(transport.row(chunk)[0].index);
        if (chunk == 0)
            gather_rows(*block, source, gathered);
        else
            scatter_columns(*block, source, gathered);
        EXPECT_TRUE(adjoint.lower(transport, system, gathered));
        const Quality now = quality(matrix, transport, weight);
        EXPECT_GE(now.margin, 1.0);
        EXPECT_LE(now.excess, excess);
        excess = now.excess;
    }
    EXPECT_LE(excess, 1.2);
}

TEST(Adjoint, CertificateByReadsIsTightWithinFewReads) {
    for (const std::size_t rooms : {1u, 4u, 32u}) {
        test::Matrix matrix =
            test::random_matrix({.patches = 320, .chunk_patches = 10, .rooms = rooms, .door = 1e-3}, 3);
        // A row of rooms: only neighbours see each other, and the last one has an opening.
        std::erase_if(matrix.pairs, [&](const ExchangePair& pair) {
            const auto room = [&](PatchNumber i) { return static_cast<long>(i * rooms / 320); };
            return std::abs(room(pair.i) - room(pair.j)) > 1;
        });
        std::fill(matrix.diagonal_m2.begin(), matrix.diagonal_m2.end(), 0.0);
        const std::vector<double> open = matrix.row_open_m2();
        for (std::size_t i = 0; i < 320; ++i) matrix.diagonal_m2[i] = i < 310 ? open[i] : 0.9 * open[i];
        const std::vector<Rgb> white(320, Rgb(1, 1, 1));
        MemoryBlocks blocks = matrix.blocks();
        Transport transport(blocks, white, {true, true, true});
        std::vector<std::uint8_t> emits(320, 0);
        emits[0] = 1;
        const auto weights = certificate_by_reads(transport, emits, true);
        ASSERT_TRUE(weights);
        const Quality found = quality(matrix, transport, [&](PatchNumber i) { return (*weights)[i]; });
        EXPECT_GE(found.margin, 1.0 - 1e-6);
        EXPECT_LE(found.excess, 4.0);
        std::printf("%zu white rooms in a row: %.1f reads, largest weight / exact %.2f, exact up to %.3g\n", rooms,
                    static_cast<double>(blocks.bytes_read()) / static_cast<double>(blocks.total_bytes()), found.excess,
                    (*weights)[0][0] / found.excess);
    }
}

}  // namespace
}  // namespace luxel
