// Fragments as shapes: points fall inside, evenly, and whole squares keep their strata.
#include "baker/patches/fragment_polygon.h"

#include <gtest/gtest.h>

#include "baker/patches/texel_raster.h"
#include "baker/unwrap/unwrap.h"
#include "tests/unit/unwrap/made_scene.h"

namespace luxel {
namespace {

class FragmentPolygons : public testing::Test {
  protected:
    void SetUp() override {
        test::add_object(scene_, "box", test::box(2, 1, 3), 1);
        test::add_object(scene_, "sphere", test::sphere(12, 0.7f), 2);
        UnwrapOptions options;
        options.texels_per_metre = 13;
        std::vector<Warning> warnings;
        atlas_ = unwrap(scene_, options, warnings, {});
        texels_ = raster_texels(scene_, atlas_);
    }
    template <class Body>
    void for_each_fragment(const Body& body) {
        for (const PageTexels& page : texels_.pages)
            for (const Fragment& fragment : page.fragments) body(fragment, fragment_polygon(scene_, atlas_, fragment));
    }
    [[nodiscard]] Vec2f page_point(std::uint32_t t, const Vec2f& b) const {
        const Vec2f a = atlas_.page_uv(t, 0);
        return a + (atlas_.page_uv(t, 1) - a) * b.x + (atlas_.page_uv(t, 2) - a) * b.y;
    }
    Scene scene_;
    Atlas atlas_;
    TexelSet texels_;
};

TEST_F(FragmentPolygons, HaveTheAreaOfTheirFragment) {
    for_each_fragment([&](const Fragment& fragment, const FragmentPolygon& polygon) {
        const auto corners = polygon.corners();
        ASSERT_GE(corners.size(), 3u);
        ASSERT_LE(corners.size(), 7u);
        double share = 0;
        for (std::size_t i = 2; i < corners.size(); ++i) {
            const Vec2f a = corners[i - 1] - corners[0], b = corners[i] - corners[0];
            share += double{a.x} * b.y - double{a.y} * b.x;
        }
        const double area = scene_.area_m2(fragment.triangle);
        EXPECT_NEAR(std::abs(share) * area, fragment.area_m2, 1e-6 * area);
    });
}

TEST_F(FragmentPolygons, PointsLieInTexelAndTriangle) {
    std::uint32_t index = 0;
    for_each_fragment([&](const Fragment& fragment, const FragmentPolygon& polygon) {
        const SobolSequence sequence(++index);
        for (std::uint32_t i = 0; i < 8; ++i) {
            const auto p = sequence.point(i);
            const Vec2f b = polygon.point(p[0], p[1]), uv = page_point(fragment.triangle, b);
            ASSERT_TRUE(b.x >= -1e-5f && b.y >= -1e-5f && b.x + b.y <= 1 + 1e-5f);
            ASSERT_TRUE(uv.x >= fragment.x - 1e-3f && uv.x <= fragment.x + 1 + 1e-3f) << uv.x << " " << fragment.x;
            ASSERT_TRUE(uv.y >= fragment.y - 1e-3f && uv.y <= fragment.y + 1 + 1e-3f);
        }
    });
}

TEST_F(FragmentPolygons, PointsAreUniform) {
    int checked = 0;
    for_each_fragment([&](const Fragment& fragment, const FragmentPolygon& polygon) {
        if (++checked % 50) return;
        const SobolSequence sequence(fragment.triangle);
        double x = 0, y = 0;
        constexpr std::uint32_t count = 1024;
        for (std::uint32_t i = 0; i < count; ++i) {
            const auto p = sequence.point(i);
            const Vec2f b = polygon.point(p[0], p[1]);
            x += b.x, y += b.y;
        }
        Vec2f low = polygon.centroid(), high = low;
        for (const Vec2f& c : polygon.corners()) {
            low = {std::min(low.x, c.x), std::min(low.y, c.y)};
            high = {std::max(high.x, c.x), std::max(high.y, c.y)};
        }
        EXPECT_NEAR(x / count, polygon.centroid().x, 5e-3 * (high.x - low.x) + 1e-7);
        EXPECT_NEAR(y / count, polygon.centroid().y, 5e-3 * (high.y - low.y) + 1e-7);
    });
    EXPECT_GT(checked, 1000);
}

TEST_F(FragmentPolygons, WholeSquaresKeepStrata) {
    int squares = 0;
    for_each_fragment([&](const Fragment& fragment, const FragmentPolygon& polygon) {
        if (!polygon.is_square()) return;
        ++squares;
        // The images of the four quarters of the unit square are the four quarters of the texel.
        unsigned seen = 0;
        for (const float s : {0.25f, 0.75f})
            for (const float t : {0.25f, 0.75f}) {
                const Vec2f uv = page_point(fragment.triangle, polygon.point(s, t));
                const float u = uv.x - fragment.x, v = uv.y - fragment.y;
                EXPECT_NEAR(std::abs(u - 0.5f), 0.25f, 1e-3);
                EXPECT_NEAR(std::abs(v - 0.5f), 0.25f, 1e-3);
                seen |= 1u << ((u > 0.5f ? 1 : 0) + (v > 0.5f ? 2 : 0));
            }
        EXPECT_EQ(seen, 15u);
    });
    EXPECT_GT(squares, 500);
}

}  // namespace
}  // namespace luxel
