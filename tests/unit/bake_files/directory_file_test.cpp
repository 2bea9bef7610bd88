/// The directory of a matrix that is not kept: what goes in comes out, and nothing else is accepted.
#include "formats/bake/directory_file.h"

#include <gtest/gtest.h>

#include "tests/support/damage.h"
#include "tests/support/temporary_folder.h"

namespace luxel {
namespace {

constexpr Key strips{3, 4};

StripDirectory example() {
    return {{{8, 8}, {0, 0}, {1, 2}, {0, 0}}, {{0, 0, 3, 40}, {0, 1, 1, 27}, {2, 2, 7, 60}}, 67};
}

TEST(DirectoryFile, ComesBackAsItWas) {
    const test::TemporaryFolder folder;
    const auto path = folder / "directory";
    EXPECT_FALSE(load_directory(path, strips));
    save_directory(path, strips, example());
    const auto found = load_directory(path, strips);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->tallies.rays, example().tallies.rays);
    EXPECT_EQ(found->tallies.self, example().tallies.self);
    EXPECT_EQ(found->tallies.open, example().tallies.open);
    EXPECT_EQ(found->tallies.back, example().tallies.back);
    EXPECT_EQ(found->blocks, example().blocks);
    EXPECT_EQ(found->hot_bytes, example().hot_bytes);
}

TEST(DirectoryFile, RefusesWhatCannotBe) {
    const test::TemporaryFolder folder;
    const auto refused = [&](const std::function<void(StripDirectory&)>& edit) {
        StripDirectory directory = example();
        edit(directory);
        save_directory(folder / "directory", strips, directory);
        return test::refused({}, [&](ByteView) { load_directory(folder / "directory", strips); });
    };
    EXPECT_FALSE(refused([](StripDirectory&) {}));
    EXPECT_TRUE(refused([](StripDirectory& d) { d.tallies.self.pop_back(); }));
    EXPECT_TRUE(refused([](StripDirectory& d) { d.tallies.back.push_back(0); }));
    EXPECT_TRUE(refused([](StripDirectory& d) { d.tallies.open[0] = d.tallies.rays[0] + 1; })) << "more ended than sent";
    EXPECT_TRUE(refused([](StripDirectory& d) { d.blocks[2] = d.blocks[1]; })) << "a block twice";
    EXPECT_TRUE(refused([](StripDirectory& d) { std::swap(d.blocks[0], d.blocks[1]); })) << "out of order";
    EXPECT_TRUE(refused([](StripDirectory& d) { d.blocks[2].b = 1; })) << "below the diagonal";
    EXPECT_TRUE(refused([](StripDirectory& d) { d.blocks[1].pair_count = 0; }));
    EXPECT_TRUE(refused([](StripDirectory& d) { d.blocks[1].stored_bytes = 0; }));
}

TEST(DirectoryFile, RefusesDamageAndOtherStrips) {
    const test::TemporaryFolder folder;
    const auto path = folder / "directory";
    save_directory(path, strips, example());
    EXPECT_TRUE(test::refused({}, [&](ByteView) { load_directory(path, {4, 3}); }));
    test::expect_guarded(path, [&] { load_directory(path, strips); });
    test::expect_tags_guarded(path, [&] { load_directory(path, strips); });
}

}  // namespace
}  // namespace luxel
