/// Irradiance of patches against the plain product with the whole matrix.
#include "baker/light/patch_irradiance.h"

#include <gtest/gtest.h>

#include <random>

#include "baker/formfactors/memory_blocks.h"

namespace luxel {
namespace {

struct Case {
    ChunkLayout layout;
    std::vector<double> area_m2, diagonal_m2;
    std::vector<ExchangePair> pairs;
    std::vector<std::array<double, 3>> radiosity;
    std::vector<Rgb> lamps;
};

Case random_case(const std::vector<PatchNumber>& first_patch, unsigned seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> uniform(0.1, 1);
    Case made;
    made.layout.first_patch = first_patch;
    const PatchNumber count = made.layout.patch_count();
    for (PatchNumber i = 0; i < count; ++i) {
        made.area_m2.push_back(uniform(random));
        made.diagonal_m2.push_back(0.01 * uniform(random));
        made.radiosity.push_back({uniform(random), 1e3 * uniform(random), 1e-3 * uniform(random)});
        made.lamps.emplace_back(static_cast<float>(uniform(random)), 0.0f, 7.0f);
        for (PatchNumber j = i + 1; j < count; ++j)
            if (random() % 2) made.pairs.push_back({i, j, static_cast<float>(0.01 * uniform(random))});
    }
    return made;
}

TEST(PatchIrradiance, IsTheProductWithTheMatrix) {
    for (const std::vector<PatchNumber>& layout :
         {std::vector<PatchNumber>{0, 1}, {0, 40}, {0, 10, 11, 40}, {0, 5, 5, 20, 33}}) {
        const Case c = random_case(layout, static_cast<unsigned>(layout.size()));
        MemoryBlocks blocks(c.layout, c.area_m2, c.diagonal_m2, c.pairs);
        const auto found = patch_irradiance(blocks, c.radiosity, c.lamps);
        std::vector<std::array<double, 3>> arrived(c.area_m2.size());
        for (std::size_t k = 0; k < 3; ++k) {
            for (std::size_t i = 0; i < arrived.size(); ++i) arrived[i][k] = c.diagonal_m2[i] * c.radiosity[i][k];
            for (const ExchangePair& pair : c.pairs) {
                arrived[pair.i][k] += static_cast<double>(pair.area_m2) * c.radiosity[pair.j][k];
                arrived[pair.j][k] += static_cast<double>(pair.area_m2) * c.radiosity[pair.i][k];
            }
        }
        ASSERT_EQ(found.size(), arrived.size());
        for (std::size_t i = 0; i < found.size(); ++i)
            for (int k = 0; k < 3; ++k) {
                const double expected =
                    arrived[i][static_cast<std::size_t>(k)] / c.area_m2[i] + static_cast<double>(c.lamps[i][k]);
                EXPECT_NEAR(found[i][k], expected, 1e-6 * expected);
            }
        EXPECT_EQ(blocks.bytes_read(), blocks.total_bytes()) << "one read of the half matrix";
    }
}

TEST(PatchIrradiance, NeverNegative) {
    ChunkLayout layout;
    layout.first_patch = {0, 1};
    MemoryBlocks blocks(layout, {1.0}, {-1e-3}, {});
    const std::vector<std::array<double, 3>> radiosity{{1, 2, 3}};
    const std::vector<Rgb> lamps{{0, 0.5f, 0}};
    EXPECT_EQ(patch_irradiance(blocks, radiosity, lamps)[0], Rgb(0, 0.5f, 0));
}

}  // namespace
}  // namespace luxel
