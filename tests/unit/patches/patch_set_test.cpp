// New numbers and back sides.
#include "baker/patches/patch_set.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "baker/patches/neighbourhoods.h"
#include "formats/base/error.h"
#include "tests/unit/patches/made_patches.h"

namespace luxel {
namespace {

using test::MadePatches;
using test::make_patches;

TEST(PatchSet, RenumberMovesEverything) {
    const MadePatches made = make_patches(test::coloured_scene());
    std::vector<bool> open(made.set.count());
    for (std::size_t p = 0; p < open.size(); ++p) open[p] = p % 3 == 0;
    const PatchSet before = add_back_sides(made.set, open);
    std::vector<PatchNumber> new_number(before.count());
    std::iota(new_number.begin(), new_number.end(), 0u);
    std::sort(new_number.begin(), new_number.end(), [](auto a, auto b) { return mix(a) < mix(b); });
    PatchSet after = before;
    renumber(after, new_number);
    ASSERT_EQ(after.count(), before.count());
    for (PatchNumber p = 0; p < before.count(); ++p) {
        const PatchNumber q = new_number[p];
        EXPECT_EQ(after.patches[q].id, before.patches[p].id);
        EXPECT_EQ(after.patches[q].other_side,
                  before.patches[p].other_side == no_patch ? no_patch : new_number[before.patches[p].other_side]);
        const auto a = after.fragments_of(q), b = before.fragments_of(p);
        ASSERT_EQ(a.size(), b.size());
        for (std::size_t f = 0; f < a.size(); ++f) EXPECT_EQ(a[f].triangle, b[f].triangle);
    }
    for (std::size_t page = 0; page < before.page_patch.size(); ++page)
        for (std::size_t i = 0; i < before.page_patch[page].size(); ++i) {
            const PatchNumber p = before.page_patch[page][i];
            EXPECT_EQ(after.page_patch[page][i], p == no_patch ? no_patch : new_number[p]);
        }
    new_number[0] = new_number[1];
    EXPECT_THROW(renumber(after, new_number), Error);
}

TEST(PatchSet, NeighbourhoodsAreSquaresOfOneSide) {
    const MadePatches made = make_patches(test::coloured_scene());
    std::vector<bool> open(made.set.count(), true);
    const PatchSet set = add_back_sides(made.set, open);
    constexpr std::uint32_t texels = 8;
    const auto of_patch = neighbourhoods(made.atlas, set, texels);
    ASSERT_EQ(of_patch.size(), set.count());
    std::vector<std::size_t> members(set.count());
    for (const std::uint32_t number : of_patch) ++members.at(number);
    EXPECT_TRUE(std::is_sorted(members.begin(), members.end(), [](std::size_t a, std::size_t b) { return a > 0 && b == 0; }));  // no gaps
    EXPECT_GT(*std::max_element(members.begin(), members.end()), 1u);
    for (PatchNumber p = 0; p < set.count(); ++p)
        for (PatchNumber q = 0; q < p; ++q) {
            const Patch &a = set.patches[p], &b = set.patches[q];
            const Fragment &f = set.fragments_of(p).front(), &g = set.fragments_of(q).front();
            const bool shines_alike = (a.emission != Rgb(0, 0, 0)) == (b.emission != Rgb(0, 0, 0));
            if (of_patch[p] == of_patch[q]) {
                EXPECT_TRUE(a.chart == b.chart && a.is_back == b.is_back && shines_alike);
                EXPECT_LT(std::abs(int{f.x} - int{g.x}), static_cast<int>(texels));
                EXPECT_LT(std::abs(int{f.y} - int{g.y}), static_cast<int>(texels));
            } else if (a.chart == b.chart && a.is_back == b.is_back && shines_alike) {
                EXPECT_FALSE(f.x == g.x && f.y == g.y);
            }
        }
}

TEST(PatchSet, BackSidesMirrorTheirFronts) {
    const MadePatches made = make_patches(test::coloured_scene());
    const std::size_t fronts = made.set.count();
    std::vector<bool> open(fronts, false);
    open[3] = open[10] = true;
    const PatchSet set = add_back_sides(made.set, open);
    ASSERT_EQ(set.count(), fronts + 2);
    for (const auto& [front, back] : {std::pair{3u, fronts}, std::pair{10u, fronts + 1}}) {
        const Patch &f = set.patches[front], &b = set.patches[back];
        EXPECT_EQ(f.other_side, back);
        EXPECT_EQ(b.other_side, front);
        EXPECT_TRUE(b.is_back);
        EXPECT_FALSE(f.is_back);
        EXPECT_NE(f.id, b.id);
        EXPECT_EQ(b.normal, -f.normal);
        EXPECT_EQ(b.area_m2, f.area_m2);
        EXPECT_EQ(b.emission, f.emission);
        EXPECT_EQ(set.fragments_of(static_cast<PatchNumber>(back)).size(), set.fragments_of(front).size());
        EXPECT_EQ(set.fragments_of(static_cast<PatchNumber>(back))[0].triangle, set.fragments_of(front)[0].triangle);
    }
    EXPECT_EQ(set.page_patch, made.set.page_patch);
    EXPECT_THROW(add_back_sides(set, std::vector<bool>(set.count(), false)), Error);
    EXPECT_THROW(add_back_sides(made.set, std::vector<bool>(3, false)), Error);
}

}  // namespace
}  // namespace luxel
