#include "baker/formfactors/block_apply.h"

#include <gtest/gtest.h>

#include <random>

namespace luxel {
namespace {

/// A block with random pairs and the dense matrix it stands for.
struct Sample {
    Block block;
    std::vector<std::vector<double>> dense;
};

Sample sample(std::size_t rows, std::size_t columns, bool diagonal, double density, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(0, 1);
    Sample result;
    result.dense.assign(rows, std::vector<double>(columns, 0.0));
    result.block.row_begin.push_back(0);
    for (std::size_t r = 0; r < rows; ++r) {
        for (std::size_t c = diagonal ? r + 1 : 0; c < columns; ++c) {
            if (uniform(random) > density) continue;
            const auto g = static_cast<float>(uniform(random));
            result.block.columns.push_back(static_cast<std::uint16_t>(c));
            result.block.areas_m2.push_back(g);
            result.dense[r][c] = static_cast<double>(g);
        }
        result.block.row_begin.push_back(static_cast<std::uint32_t>(result.block.columns.size()));
    }
    return result;
}

std::vector<Lanes> random_lanes(std::size_t count, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(-1, 1);
    std::vector<Lanes> lanes(count);
    for (Lanes& lane : lanes)
        for (double& value : lane.v) value = uniform(random);
    return lanes;
}

void expect_near(std::span<const Lanes> found, std::span<const Lanes> wanted) {
    for (std::size_t i = 0; i < found.size(); ++i)
        for (std::size_t c = 0; c < 4; ++c) EXPECT_NEAR(found[i].v[c], wanted[i].v[c], 1e-12);
}

class BlockApply : public testing::TestWithParam<double> {};

TEST_P(BlockApply, AgreesWithTheDenseProductBothWays) {
    const Sample s = sample(37, 53, false, GetParam(), 1);
    const auto x_a = random_lanes(37, 2), x_b = random_lanes(53, 3);
    const auto start_a = random_lanes(37, 4), start_b = random_lanes(53, 5);
    auto wanted_a = start_a, wanted_b = start_b;
    for (std::size_t r = 0; r < 37; ++r)
        for (std::size_t k = 0; k < 53; ++k)
            for (std::size_t c = 0; c < 4; ++c) {
                wanted_a[r].v[c] += s.dense[r][k] * x_b[k].v[c];
                wanted_b[k].v[c] += s.dense[r][k] * x_a[r].v[c];
            }
    auto y_a = start_a, y_b = start_b;
    gather_rows(s.block, x_b, y_a);
    scatter_columns(s.block, x_a, y_b);
    expect_near(y_a, wanted_a);
    expect_near(y_b, wanted_b);
    y_a = start_a;
    y_b = start_b;
    apply_both(s.block, x_a, x_b, y_a, y_b);
    expect_near(y_a, wanted_a);
    expect_near(y_b, wanted_b);
}

TEST_P(BlockApply, DiagonalBlockIsSymmetric) {
    const Sample s = sample(41, 41, true, GetParam(), 1);
    const auto x = random_lanes(41, 2);
    std::vector<Lanes> wanted(41);
    for (std::size_t r = 0; r < 41; ++r)
        for (std::size_t k = 0; k < 41; ++k)
            for (std::size_t c = 0; c < 4; ++c) wanted[r].v[c] += (s.dense[r][k] + s.dense[k][r]) * x[k].v[c];
    std::vector<Lanes> whole(41), parts(41);
    apply_diagonal(s.block, 0, 41, x, whole);
    expect_near(whole, wanted);
    for (const std::size_t first : {0u, 20u, 33u})
        apply_diagonal(s.block, first, first == 0 ? 20 : first == 20 ? 33 : 41, x, parts);
    expect_near(parts, wanted);
}

INSTANTIATE_TEST_SUITE_P(Densities, BlockApply, testing::Values(0.0, 0.03, 0.3, 1.0));

TEST(ChunkLayout, FindsTheChunkOfAPatch) {
    const ChunkLayout layout{{0, 3, 3, 8}};
    EXPECT_EQ(layout.chunk_count(), 3u);
    EXPECT_EQ(layout.chunk_of(0), 0u);
    EXPECT_EQ(layout.chunk_of(2), 0u);
    EXPECT_EQ(layout.chunk_of(3), 2u);
    EXPECT_EQ(layout.chunk_of(7), 2u);
}

}  // namespace
}  // namespace luxel
