/// What the coarse space says it sends must be what the matrix would have made of it, whatever the levels are.
#include "baker/solver/coarse_space.h"

#include <gtest/gtest.h>

#include <random>

#include "baker/solver/adjoint.h"
#include "baker/solver/coarse_vectors.h"
#include "baker/solver/whole_read.h"
#include "formats/base/error.h"
#include "tests/unit/solver/matrices.h"

namespace luxel {
namespace {

using test::Matrix;
using test::random_matrix;

class CoarseSpaceTest : public testing::Test {
  protected:
    const Matrix matrix_ =
        random_matrix({.patches = 150, .chunk_patches = 40, .density = 0.4, .rooms = 3, .door = 0.1}, 11);
    const std::vector<Rgb> reflectance_ = test::random_reflectance(150, 0.0f, 0.9f, 3);
    MemoryBlocks blocks_ = matrix_.blocks();
    Transport transport_{blocks_, reflectance_, {true, true, true}};
    CoarseSpace space_{transport_};

    void SetUp() override {
        const std::vector<Lanes> x(150);
        (void)exchange_and_columns(transport_, x, space_);
        ASSERT_GE(space_.vector_count(), transport_.layout().chunk_count());
    }
    [[nodiscard]] std::vector<Channels> random_channels(unsigned seed) const {
        std::mt19937_64 random(seed);
        std::uniform_real_distribution<double> uniform(-1, 1);
        std::vector<Channels> values(150);
        for (Channels& value : values)
            for (double& v : value) v = uniform(random);
        return values;
    }
    /// sum over j != i of G_ij x_j, from the dense matrix.
    [[nodiscard]] Eigen::VectorXd received(const std::vector<Channels>& sent, std::size_t channel) const {
        Eigen::MatrixXd g = matrix_.dense();
        g.diagonal().setZero();
        Eigen::VectorXd x(150);
        for (Eigen::Index i = 0; i < 150; ++i) x(i) = sent[static_cast<std::size_t>(i)][channel];
        return g * x;
    }
};

TEST_F(CoarseSpaceTest, WhatIsSentArrivesAsTheMatrixSays) {
    std::vector<Channels> levels = random_channels(1);
    levels.resize(space_.vector_count());
    std::vector<Channels> irradiance(150, {0, 0, 0}), unshot(150, {0, 0, 0}), sent(150, {0, 0, 0});
    space_.send(levels, irradiance, unshot);
    for (ChunkNumber chunk = 0; chunk < transport_.layout().chunk_count(); ++chunk) {
        const CoarseSpace::Exchange exchange = space_.exchange(chunk, levels);
        std::copy(exchange.sent.begin(), exchange.sent.end(), sent.begin() + transport_.first(chunk));
    }
    for (std::size_t c = 0; c < 3; ++c) {
        const Eigen::VectorXd expected = received(sent, c);
        for (PatchNumber i = 0; i < 150; ++i) {
            const double arrived = expected(i) / matrix_.area_m2[i];
            EXPECT_NEAR(irradiance[i][c], arrived, 1e-12 * (1 + std::abs(arrived)));
            EXPECT_NEAR(unshot[i][c], transport_.scaled_reflectance(i)[c] * arrived - sent[i][c],
                        1e-12 * (1 + std::abs(sent[i][c])));
        }
    }
}

TEST_F(CoarseSpaceTest, ItsLevelsLeaveNothingThatTheModelCanSee) {
    std::vector<Channels> unshot = random_channels(2), irradiance(150, {0, 0, 0});
    for (PatchNumber i = 0; i < 150; ++i)
        for (std::size_t c = 0; c < 3; ++c) unshot[i][c] *= transport_.scaled_reflectance(i)[c];
    const std::vector<Channels> levels = space_.levels(unshot);
    ASSERT_EQ(levels.size(), space_.vector_count());
    space_.send(levels, irradiance, unshot);
    for (const Channels& rest : space_.levels(unshot))
        for (const double level : rest) EXPECT_NEAR(level, 0, 1e-10);
}

TEST_F(CoarseSpaceTest, ItsWeightsAreACertificate) {
    const std::vector<std::uint8_t> emits(150, 1);
    Adjoint adjoint = Adjoint::certify(transport_, emits);
    double before = 0, after = 0;
    for (PatchNumber i = 0; i < 150; ++i) before += matrix_.area_m2[i] * adjoint.weight(i)[0];
    ASSERT_TRUE(adjoint.lower_by(space_, transport_));
    for (std::size_t c = 0; c < 3; ++c) {
        std::vector<Channels> source(150);
        for (PatchNumber i = 0; i < 150; ++i) source[i][c] = transport_.scaled_reflectance(i)[c] * adjoint.weight(i)[c];
        const Eigen::VectorXd transported = received(source, c);
        for (PatchNumber i = 0; i < 150; ++i) EXPECT_GE(adjoint.weight(i)[c], 1 + transported(i) / matrix_.area_m2[i]);
    }
    for (PatchNumber i = 0; i < 150; ++i) after += matrix_.area_m2[i] * adjoint.weight(i)[0];
    EXPECT_LT(after, 0.7 * before);
}

TEST_F(CoarseSpaceTest, ComesBackFromItsNumbers) {
    CoarseSpace again(transport_);
    again.restore(space_.save());
    EXPECT_EQ(again.vector_count(), space_.vector_count());
    EXPECT_EQ(again.entries(), space_.entries());
    const std::vector<Channels> unshot = random_channels(3);
    EXPECT_EQ(again.levels(unshot), space_.levels(unshot));
    EXPECT_EQ(again.save(), space_.save());
}

TEST_F(CoarseSpaceTest, NumbersOfSomethingElseAreRefused) {
    const std::vector<double> numbers = space_.save();
    for (std::size_t k = 1; k < 40; ++k) {
        std::vector<double> cut(numbers.begin(), numbers.end() - static_cast<std::ptrdiff_t>(k));
        CoarseSpace again(transport_);
        EXPECT_THROW(again.restore(cut), Error) << k;
    }
    for (const double bad : {-1.0, 0.5, 1e9, std::nan("")}) {
        std::vector<double> wrong = numbers;
        wrong[0] = bad;
        CoarseSpace again(transport_);
        EXPECT_THROW(again.restore(wrong), Error) << bad;
    }
}

TEST_F(CoarseSpaceTest, WhatItHoldsAlreadyIsNotTakenTwice) {
    const std::vector<Lanes> radiosity = space_.radiosity(0);
    const ChunkSystem system(transport_, 0, transport_.load_diagonal(0).get());
    std::vector<Lanes> own;
    system.multiply(radiosity, own);
    EXPECT_FALSE(space_.add(0, radiosity, own));
}

}  // namespace
}  // namespace luxel
