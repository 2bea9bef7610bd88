/// Points moved onto the visible cells: uniform over them, and in no other.
#include "baker/patches/visible_cells.h"

#include <gtest/gtest.h>

#include <array>

namespace luxel {
namespace {

std::uint32_t cell_of(const Vec2f& at) {
    return static_cast<std::uint32_t>(at.y * cells_across) * cells_across + static_cast<std::uint32_t>(at.x * cells_across);
}

TEST(VisibleCells, MiddlesLieInTheirCells) {
    for (std::uint32_t cell = 0; cell < 16; ++cell) EXPECT_EQ(cell_of(cell_middle(cell)), cell);
}

TEST(VisibleCells, AllVisibleMovesNothing) {
    EXPECT_EQ(onto_visible(all_visible, 0.3f, 0.7f), Vec2f(0.3f, 0.7f));
}

/// Every set of cells: a grid of points falls on its cells in equal numbers, and stays in the unit square.
TEST(VisibleCells, UniformOverTheVisible) {
    constexpr std::uint32_t side = 48;  // divisible by every number of cells in a row, 16 rows too
    for (std::uint32_t cells = 1; cells <= all_visible; ++cells) {
        const auto count = static_cast<std::uint32_t>(std::popcount(cells));
        std::array<std::uint32_t, 16> met{};
        for (std::uint32_t y = 0; y < count; ++y)
            for (std::uint32_t x = 0; x < side; ++x) {
                const Vec2f at = onto_visible(static_cast<VisibleCells>(cells), (static_cast<float>(x) + 0.5f) / side,
                                              (static_cast<float>(y) + 0.5f) / static_cast<float>(count));
                ASSERT_TRUE(at.x >= 0 && at.x < 1 && at.y >= 0 && at.y < 1);
                ++met[cell_of(at)];
            }
        for (std::uint32_t cell = 0; cell < 16; ++cell) ASSERT_EQ(met[cell], cells >> cell & 1u ? side : 0u) << cells;
    }
    for (const float high : {0.0f, 0x1.fffffep-1f})
        for (std::uint32_t cells = 1; cells <= all_visible; ++cells) {
            const Vec2f at = onto_visible(static_cast<VisibleCells>(cells), high, high);
            ASSERT_TRUE(cells >> cell_of(at) & 1u) << cells << " " << high;
        }
}

}  // namespace
}  // namespace luxel
