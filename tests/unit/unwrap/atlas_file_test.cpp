// The atlas survives the disk, and a file that does not fit the scene is refused.
#include "baker/unwrap/atlas_file.h"

#include <gtest/gtest.h>

#include "baker/unwrap/unwrap.h"
#include "tests/unit/unwrap/made_scene.h"

namespace luxel {
namespace {

class AtlasFile : public testing::Test {
  protected:
    void SetUp() override {
        path_ = std::filesystem::path(testing::TempDir()) / "luxel_atlas_file_test.atlas";
        test::add_object(scene_, "box", test::box(1, 2, 3), 1);
        test::add_object(scene_, "sphere", test::sphere(8, 1), 2);
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
}

TEST_F(AtlasFile, RefusesWhatDoesNotFit) {
    save_atlas(path_, key_, atlas_);
    EXPECT_THROW(load_atlas(path_, Key{3, 4}, scene_), Error);
    Scene other;
    test::add_object(other, "box", test::box(1, 2, 3), 1);
    EXPECT_THROW(load_atlas(path_, key_, other), Error);

    const auto refused = [&](const Atlas& damaged) {
        save_atlas(path_, key_, damaged);
        EXPECT_THROW(load_atlas(path_, key_, scene_), Error);
    };
    Atlas damaged = atlas_;
    damaged.corner_uv[5].x = std::numeric_limits<float>::quiet_NaN();
    refused(damaged);
    damaged = atlas_;
    damaged.corner_uv[5].y = -1;
    refused(damaged);
    damaged = atlas_;
    damaged.chart_triangles[1] = damaged.chart_triangles[0];
    refused(damaged);
    damaged = atlas_;
    damaged.charts[0].x = 5000;
    refused(damaged);
    damaged = atlas_;
    damaged.charts[0].count += 1;
    refused(damaged);
    damaged = atlas_;
    damaged.charts.pop_back();
    refused(damaged);
    damaged = atlas_;
    damaged.charts[0].object = 77;
    refused(damaged);
    damaged = atlas_;
    damaged.texels_per_metre = 0;
    refused(damaged);
}

}  // namespace
}  // namespace luxel
