/// Random legal pair blocks of strips, and their comparison.
#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

#include "formats/bake/strip_file.h"

namespace luxel::test {

inline void expect_equal(const StripPairs& a, const StripPairs& b) {
    EXPECT_EQ(a.rows, b.rows);
    EXPECT_EQ(a.columns, b.columns);
    EXPECT_EQ(a.row_begin, b.row_begin);
    EXPECT_EQ(a.column, b.column);
    EXPECT_EQ(a.count, b.count);
}

/// `pairs` draws in a block of the given size (doubles are one pair); on a diagonal block only columns above the row.
inline StripPairs random_pairs(std::uint32_t rows, std::uint32_t columns, std::size_t pairs, bool diagonal,
                               std::mt19937_64& random) {
    std::set<std::pair<std::uint32_t, std::uint16_t>> places;
    for (std::size_t k = 0; k < pairs; ++k) {
        const auto row = static_cast<std::uint32_t>(random() % rows);
        const auto column = static_cast<std::uint32_t>(random() % columns);
        if (!diagonal || column > row) places.emplace(row, static_cast<std::uint16_t>(column));
    }
    StripPairs block;
    block.rows = rows;
    block.columns = columns;
    block.row_begin.assign(rows + 1, 0);
    for (const auto& [row, column] : places) {
        ++block.row_begin[row + 1];
        block.column.push_back(column);
        // Most counts are small; some need all 32 bits.
        block.count.push_back(random() % 8
                                  ? static_cast<std::uint32_t>(1 + random() % 5)
                                  : static_cast<std::uint32_t>(std::max<std::uint64_t>(1, random() & 0xffffffffu)));
    }
    for (std::uint32_t row = 0; row < rows; ++row) block.row_begin[row + 1] += block.row_begin[row];
    return block;
}

}  // namespace luxel::test
