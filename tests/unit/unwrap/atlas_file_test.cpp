// The atlas survives the disk, and a file that does not fit the scene is refused.
#include "baker/unwrap/atlas_file.h"

#include <gtest/gtest.h>

#include "baker/unwrap/unwrap.h"
#include "tests/support/damage.h"
#include "tests/unit/unwrap/made_scene.h"

namespace luxel {
namespace {

class AtlasFile : public testing::Test {
  protected:
    void SetUp() override {
        path_ = std::filesystem::path(testing::TempDir()) / "luxel_atlas_file_test.atlas";
        test::add_object(scene_, "box", test::box(1, 2, 3), 1);
        test::add_object(scene_, "sphere", test::sphere(8, 1), 2);
        test::add_object(scene_, "copy", test::sphere(8, 1), 2, [](const Vec3f& p) { return p + Vec3f(5, 0, 0); });
        std::vector<Warning> warnings;
        atlas_ = unwrap(scene_, {}, warnings, {});
    }
    void TearDown() override { std::filesystem::remove(path_); }
    std::filesystem::path path_;
    Scene scene_;
    Atlas atlas_;
    const Key key_{1, 2};
};

TEST_F(AtlasFile, ComesBackEqual) {
    save_atlas(path_, key_, atlas_);
    const Atlas read = load_atlas(path_, key_, scene_);
    EXPECT_EQ(read.texels_per_metre, atlas_.texels_per_metre);
    EXPECT_EQ(read.page_size, atlas_.page_size);
    EXPECT_EQ(read.page_count, atlas_.page_count);
    EXPECT_EQ(read.padding, atlas_.padding);
    EXPECT_EQ(read.chart_triangles, atlas_.chart_triangles);
    EXPECT_EQ(read.triangle_chart, atlas_.triangle_chart);
    EXPECT_EQ(read.corner_uv, atlas_.corner_uv);
    ASSERT_EQ(read.charts.size(), atlas_.charts.size());
    for (std::size_t c = 0; c < read.charts.size(); ++c) {
        EXPECT_EQ(read.charts[c].x, atlas_.charts[c].x);
        EXPECT_EQ(read.charts[c].ordinal, atlas_.charts[c].ordinal);
        EXPECT_EQ(read.charts[c].count, atlas_.charts[c].count);
    }
    ASSERT_EQ(read.copy_blocks.size(), 2u);
    ASSERT_EQ(atlas_.copy_blocks.size(), 2u);
    for (std::size_t b = 0; b < 2; ++b) {
        EXPECT_EQ(read.copy_blocks[b].first_object, b + 1);
        EXPECT_EQ(read.copy_blocks[b].x, atlas_.copy_blocks[b].x);
        EXPECT_EQ(read.copy_blocks[b].height, atlas_.copy_blocks[b].height);
    }
}

TEST_F(AtlasFile, RefusesDamage) {
    // Two boxes only: every bit of the file is tried.
    Scene scene;
    test::add_object(scene, "box", test::box(1, 2, 3), 1);
    test::add_object(scene, "copy", test::box(1, 2, 3), 1, [](const Vec3f& p) { return p + Vec3f(5, 0, 0); });
    std::vector<Warning> warnings;
    save_atlas(path_, key_, unwrap(scene, {}, warnings, {}));
    const auto load = [&] { load_atlas(path_, key_, scene); };
    test::expect_guarded(path_, load);
    test::expect_tags_guarded(path_, load);
}

TEST_F(AtlasFile, RefusesWhatDoesNotFit) {
    save_atlas(path_, key_, atlas_);
    EXPECT_TRUE(test::file_refused(path_, [&] { load_atlas(path_, Key{3, 4}, scene_); }));
    Scene other;
    test::add_object(other, "box", test::box(1, 2, 3), 1);
    EXPECT_TRUE(test::file_refused(path_, [&] { load_atlas(path_, key_, other); }));

    const auto refused = [&](const std::function<void(Atlas&)>& change) {
        Atlas damaged = atlas_;
        change(damaged);
        save_atlas(path_, key_, damaged);
        return test::file_refused(path_, [&] { load_atlas(path_, key_, scene_); });
    };
    const float no_number = std::numeric_limits<float>::quiet_NaN(), infinite = std::numeric_limits<float>::infinity();
    EXPECT_FALSE(refused([](Atlas&) {}));
    EXPECT_TRUE(refused([&](Atlas& a) { a.corner_uv[5].x = no_number; }));
    EXPECT_TRUE(refused([](Atlas& a) { a.corner_uv[5].y = -1; }));
    EXPECT_TRUE(refused([&](Atlas& a) { a.corner_uv[5].y = infinite; }));
    EXPECT_TRUE(refused([](Atlas& a) { a.corner_uv.pop_back(); }));
    EXPECT_TRUE(refused([](Atlas& a) { a.chart_triangles[1] = a.chart_triangles[0]; })) << "a triangle twice";
    EXPECT_TRUE(refused([](Atlas& a) { a.chart_triangles[0] = 100000; })) << "a triangle beyond the scene";
    EXPECT_TRUE(refused([](Atlas& a) { std::swap(a.chart_triangles[0], a.chart_triangles[1]); }))
        << "triangles out of order";
    EXPECT_TRUE(refused([](Atlas& a) { a.charts[0].x = 5000; }));
    EXPECT_TRUE(refused([](Atlas& a) { a.charts[0].y = 0xffffffff; })) << "a place that overflows";
    EXPECT_TRUE(refused([](Atlas& a) { a.charts[0].width = 0; }));
    EXPECT_TRUE(refused([](Atlas& a) { a.charts[0].page = a.page_count; }));
    EXPECT_TRUE(refused([](Atlas& a) { a.charts[0].count += 1; }));
    EXPECT_TRUE(refused([](Atlas& a) { a.charts[0].count = 0; })) << "a count of zero";
    EXPECT_TRUE(refused([](Atlas& a) { a.charts[1].first = 0; })) << "runs that overlap";
    EXPECT_TRUE(refused([](Atlas& a) { a.charts.pop_back(); }));
    EXPECT_TRUE(refused([](Atlas& a) { std::swap(a.charts[0], a.charts[1]); })) << "charts out of order";
    EXPECT_TRUE(refused([](Atlas& a) { a.charts[1].ordinal = 0; })) << "two charts of one number";
    EXPECT_TRUE(refused([](Atlas& a) { a.charts[0].object = 77; }));
    EXPECT_TRUE(refused([](Atlas& a) { a.charts[0].object = 1; })) << "a triangle of another object";
    EXPECT_TRUE(refused([](Atlas& a) { a.texels_per_metre = 0; }));
    EXPECT_TRUE(refused([&](Atlas& a) { a.texels_per_metre = no_number; }));
    EXPECT_TRUE(refused([](Atlas& a) { a.page_size = 16385; })) << "a larger page than any";
    EXPECT_TRUE(refused([](Atlas& a) { a.page_count = 1000000; })) << "pages without charts";
    EXPECT_TRUE(refused([](Atlas& a) { a.padding = a.page_size; }));
}

}  // namespace
}  // namespace luxel
