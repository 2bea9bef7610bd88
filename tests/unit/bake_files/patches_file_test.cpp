/// Patches files: pinned bytes of patches_file.md, round trip, and refusal of damage and of everything that the page
/// names.
#include "formats/bake/patches_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/support/damage.h"
#include "tests/support/temporary_folder.h"

namespace luxel {
namespace {

const Key key{7, 8};

PatchesFile example() { return {{0x10}, {0.5}, {0, 1}, {{1, 2}}, {3, 4}, "ray"}; }

PatchesFile five_patches() {
    return {
        {9, 3, ~std::uint64_t{0}, 0, 4}, {1, 2, 0.25, 1e-9, 1e12}, {0, 2, 2, 5}, {{1, 2}, {3, 4}}, {5, 6}, "hemicube"};
}

class PatchesFileTest : public testing::Test {
  protected:
    [[nodiscard]] bool refuses(const PatchesFile& patches) {
        save_patches(path_, key, patches);
        return refuses_file();
    }
    /// The valid file with other contents and right checksums.
    [[nodiscard]] bool refuses_changed(const std::function<void(test::BlockContents&)>& change) {
        save_patches(path_, key, five_patches());
        test::rewrite(path_, change);
        return refuses_file();
    }
    [[nodiscard]] bool refuses_file() const { return test::file_refused(path_, load_); }

    const test::TemporaryFolder folder_;
    const std::filesystem::path path_ = folder_ / "patches";
    const std::function<void()> load_ = [this] { load_patches(path_, key); };
};

TEST_F(PatchesFileTest, ExampleOfTheDocument) {
    save_patches(path_, key, example());
    EXPECT_EQ(load_patches(path_, key), example());
    const std::vector<Bytes> expected{{0x10, 0, 0, 0, 0, 0, 0, 0},
                                      {0, 0, 0, 0, 0, 0, 0xe0, 0x3f},
                                      {0, 0, 0, 0, 1, 0, 0, 0},
                                      {1, 0, 0, 0, 0, 0, 0, 0, 2, 0, 0, 0, 0, 0, 0, 0},
                                      {3, 0, 0, 0, 0, 0, 0, 0, 4, 0, 0, 0, 0, 0, 0, 0},
                                      {0x72, 0x61, 0x79}};
    const auto parts = test::contents_of(path_).parts;
    ASSERT_EQ(parts.size(), expected.size());
    for (std::size_t k = 0; k < parts.size(); ++k) {
        EXPECT_EQ(parts[k].tag, k);
        EXPECT_EQ(parts[k].bytes, expected[k]) << "block " << k;
    }
}

TEST_F(PatchesFileTest, ReturnsWhatWasWritten) {
    for (const PatchesFile& patches : {five_patches(), PatchesFile{{}, {}, {0}, {}, {}, ""}}) {
        save_patches(path_, key, patches);
        EXPECT_EQ(load_patches(path_, key), patches);
    }
    const Key other{7, 9};
    EXPECT_TRUE(test::file_refused(path_, [&] { load_patches(path_, other); })) << "made for other strips";
}

TEST_F(PatchesFileTest, RefusesDamage) {
    save_patches(path_, key, five_patches());
    test::expect_guarded(path_, load_);
    test::expect_tags_guarded(path_, load_);
}

TEST_F(PatchesFileTest, RefusesValuesOutOfRange) {
    const auto with = [](const std::function<void(PatchesFile&)>& change) {
        PatchesFile patches = five_patches();
        change(patches);
        return patches;
    };
    EXPECT_FALSE(refuses(five_patches()));
    for (const double area : {0.0, -1.0, std::numeric_limits<double>::infinity(), std::nan("")})
        EXPECT_TRUE(refuses(with([&](auto& p) { p.area_m2[3] = area; }))) << "area " << area;
    EXPECT_TRUE(refuses(with([](auto& p) { p.ids[4] = p.ids[1]; }))) << "an id twice";
    EXPECT_TRUE(refuses(with([](auto& p) { p.ids.pop_back(); }))) << "fewer ids than areas";
    EXPECT_TRUE(refuses(with([](auto& p) { p.first_patch = {}; }))) << "no chunks";
    EXPECT_TRUE(refuses(with([](auto& p) { p.first_patch[0] = 1; }))) << "a first patch without chunk";
    EXPECT_TRUE(refuses(with([](auto& p) { p.first_patch.back() = 4; }))) << "a last patch without chunk";
    EXPECT_TRUE(refuses(with([](auto& p) { p.first_patch.back() = 6; }))) << "a chunk beyond the patches";
    EXPECT_TRUE(refuses(with([](auto& p) { p.first_patch = {0, 3, 2, 5}; }))) << "chunks out of order";
    EXPECT_TRUE(refuses(with([](auto& p) { p.estimator = std::string(65, 'x'); }))) << "a long name";
    EXPECT_TRUE(refuses(with([](auto& p) { p.estimator = "ray\n"; }))) << "a name with control characters";
    PatchesFile large{{}, std::vector<double>(65537, 1), {0, 65537}, {}, {}, "ray"};
    for (std::uint64_t id = 0; id < 65537; ++id) large.ids.push_back(id);
    EXPECT_TRUE(refuses(large)) << "a chunk of more patches than 16 bits can number";
    large.first_patch = {0, 65536, 65537};
    EXPECT_FALSE(refuses(large));
}

TEST_F(PatchesFileTest, RefusesOtherShapes) {
    EXPECT_FALSE(refuses_changed([](auto&) {}));
    EXPECT_TRUE(refuses_changed([](auto& file) { file.parts.pop_back(); })) << "a block too few";
    EXPECT_TRUE(refuses_changed([](auto& file) { file.parts.push_back({6, {}}); })) << "a block too many";
    EXPECT_TRUE(refuses_changed([](auto& file) { std::swap(file.parts[3], file.parts[4]); })) << "blocks out of order";
    for (const std::size_t block : {0u, 1u, 2u, 3u, 4u})
        EXPECT_TRUE(refuses_changed([&](auto& file) { file.parts[block].bytes.pop_back(); }))
            << "a cut number in block " << block;
    EXPECT_TRUE(refuses_changed([](auto& file) { file.parts[3].bytes.resize(24); })) << "half a key of evidence";
    EXPECT_TRUE(refuses_changed([](auto& file) { file.parts[4].bytes.resize(8); })) << "half a key of the closure";
    EXPECT_TRUE(refuses_changed([](auto& file) { file.parts[4].bytes.resize(32); })) << "two keys of the closure";
}

}  // namespace
}  // namespace luxel
