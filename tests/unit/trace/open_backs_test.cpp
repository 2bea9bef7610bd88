/// Which sides of two-sided surfaces get patches: those that light can reach.
#include "baker/trace/open_backs.h"

#include <gtest/gtest.h>

#include "tests/support/scenes.h"

namespace luxel {
namespace {

using test::SceneMaker;

/// Number of patches with an open back on the object with this path, and of all its front patches.
std::pair<std::size_t, std::size_t> open_backs(const test::Prepared& made, const std::string& path) {
    std::size_t open = 0, all = 0;
    for (PatchNumber p = 0; p < made.patches.count(); ++p) {
        const Patch& patch = made.patches.patches[p];
        if (made.path_of(p) != path || patch.is_back) continue;
        ++all;
        open += patch.other_side != no_patch;
    }
    return {open, all};
}

TEST(OpenBacks, OnlyWhereLightCanBe) {
    test::MadeMaterial two_sided;
    two_sided.double_sided = true;
    const auto made = test::prepare(SceneMaker()
                                        .add("walls", test::room({0, 0, 0}, {4, 3, 4}), two_sided)
                                        .add("solid", test::moved(test::box(0.5f, 0.5f, 0.5f), {1, 1, 1}), two_sided)
                                        .add("sheet", test::quad({2, 1, 1}, {0, 1, 0}, {0, 0, 1}), two_sided)
                                        .add("one sided", test::quad({3, 1, 1}, {0, 1, 0}, {0, 0, 1}))
                                        .build());
    EXPECT_EQ(open_backs(*made, "walls").first, 0u) << "outside there is nothing";
    EXPECT_EQ(open_backs(*made, "solid").first, 0u) << "inside there are backs only";
    EXPECT_EQ(open_backs(*made, "one sided").first, 0u);
    const auto sheet = open_backs(*made, "sheet");
    EXPECT_EQ(sheet.first, sheet.second);
    EXPECT_GT(sheet.second, 0u);
}

TEST(OpenBacks, DoNotDependOnNumbers) {
    test::MadeMaterial two_sided;
    two_sided.double_sided = true;
    const auto scene = [&] {
        return SceneMaker()
            .add("walls", test::room({0, 0, 0}, {4, 3, 4}))
            .add("sphere", test::moved(test::icosphere(1, 0.7f), {2, 0.5f, 2}), two_sided)  // sunk into the floor
            .build();
    };
    const auto a = test::prepare(scene(), {.chunk_patches = 20}), b = test::prepare(scene(), {.chunk_patches = 4096});
    auto ids_a = a->ids(), ids_b = b->ids();
    EXPECT_NE(ids_a, ids_b);
    std::sort(ids_a.begin(), ids_a.end()), std::sort(ids_b.begin(), ids_b.end());
    EXPECT_EQ(ids_a, ids_b);
}

}  // namespace
}  // namespace luxel
