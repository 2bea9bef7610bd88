/// One count and many: the same float.
#include "baker/formfactors/exchange_area.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace luxel {
namespace {

TEST(ExchangeArea, IsSymmetricPositiveAndNormal) {
    EXPECT_EQ(exchange_area(3, 7.1, 0.3), exchange_area(3, 0.3, 7.1));
    EXPECT_GT(exchange_area(1, 1e300, 1e300), 0.0f);
    EXPECT_FLOAT_EQ(exchange_area(1, 0.0, 4.0), 0.25f);
}

TEST(ExchangeArea, ABlockIsItsPairs) {
    std::mt19937_64 random(1);
    for (int round = 0; round < 200; ++round) {
        std::vector<std::uint32_t> begin{0}, counts;
        std::vector<std::uint16_t> columns;
        std::vector<double> mu_rows, mu_columns(50);
        for (double& mu : mu_columns) mu = random() % 7 ? static_cast<double>(random() % 100000) * 1e-3 : 1e300;
        for (std::size_t row = 0; row < 1 + random() % 9; ++row) {
            mu_rows.push_back(static_cast<double>(1 + random() % 1000));
            for (std::uint16_t column = 0; column < mu_columns.size(); ++column) {
                if (random() % (1 + row * 5)) continue;
                columns.push_back(column);
                counts.push_back(random() % 3 ? static_cast<std::uint32_t>(1 + random() % 40)
                                              : std::max<std::uint32_t>(1, static_cast<std::uint32_t>(random())));
            }
            begin.push_back(static_cast<std::uint32_t>(columns.size()));
        }
        std::vector<float> areas(columns.size());
        exchange_areas(begin, columns, counts, mu_rows.data(), mu_columns.data(), areas);
        for (std::size_t row = 0; row + 1 < begin.size(); ++row)
            for (std::size_t k = begin[row]; k < begin[row + 1]; ++k)
                EXPECT_EQ(areas[k], exchange_area(counts[k], mu_rows[row], mu_columns[columns[k]])) << row << ", " << k;
    }
}

}  // namespace
}  // namespace luxel
