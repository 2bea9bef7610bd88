// unwrap(): complete, free of overlaps, the same for any number of threads, and stable when other objects change.
#include "baker/unwrap/unwrap.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "baker/core/parallel.h"
#include "tests/unit/unwrap/made_scene.h"

namespace luxel {
namespace {

using test::add_object;

double uv_area(const Atlas& atlas, std::uint32_t t) {
    const Vec2f a = atlas.page_uv(t, 0), b = atlas.page_uv(t, 1) - a, c = atlas.page_uv(t, 2) - a;
    return 0.5 * std::abs(double{b.x} * c.y - double{b.y} * c.x);
}

/// Every triangle once, coordinates inside charts, charts inside pages and `padding` apart.
void expect_sound(const Scene& scene, const Atlas& atlas) {
    std::vector<int> seen(scene.triangle_count(), 0);
    for (std::uint32_t c = 0; c < atlas.charts.size(); ++c) {
        const Chart& chart = atlas.charts[c];
        ASSERT_LT(chart.page, atlas.page_count);
        ASSERT_GE(std::min(chart.x, chart.y), atlas.padding);
        ASSERT_LE(chart.x + chart.width + atlas.padding, atlas.page_size);
        ASSERT_LE(chart.y + chart.height + atlas.padding, atlas.page_size);
        for (std::uint32_t i = chart.first; i < chart.first + chart.count; ++i) {
            const std::uint32_t t = atlas.chart_triangles[i];
            ++seen[t];
            ASSERT_EQ(atlas.triangle_chart[t], c);
            ASSERT_EQ(scene.triangle_object[t], chart.object);
            for (std::size_t k = 0; k < 3; ++k) {
                const Vec2f& uv = atlas.corner_uv[3 * t + k];
                ASSERT_TRUE(uv.x >= 0 && uv.x <= static_cast<float>(chart.width)) << uv.x;
                ASSERT_TRUE(uv.y >= 0 && uv.y <= static_cast<float>(chart.height)) << uv.y;
            }
        }
    }
    EXPECT_TRUE(std::all_of(seen.begin(), seen.end(), [](int n) { return n == 1; }));
    std::vector<std::vector<bool>> taken(atlas.page_count);
    for (auto& page : taken) page.assign(std::size_t{atlas.page_size} * atlas.page_size, false);
    for (const Chart& chart : atlas.charts)  // each with its padding to the right and below
        for (std::uint32_t y = chart.y; y < chart.y + chart.height + atlas.padding; ++y)
            for (std::uint32_t x = chart.x; x < chart.x + chart.width + atlas.padding; ++x) {
                const std::size_t at = std::size_t{y} * atlas.page_size + x;
                ASSERT_FALSE(taken[chart.page][at]) << "charts closer than the padding";
                taken[chart.page][at] = true;
            }
}

Scene mixed_scene() {
    Scene scene;
    add_object(scene, "box", test::box(2, 1, 3), 1);
    add_object(scene, "sphere", test::sphere(20, 0.7f), 2);
    add_object(scene, "terrain", test::terrain(40, 0.05f, 0.5f), 3);
    add_object(scene, "rough", test::terrain(30, 0.05f, 3.0f), 4);
    return scene;
}

Atlas unwrap_quietly(const Scene& scene, const UnwrapOptions& options = {}) {
    std::vector<Warning> warnings;
    return unwrap(scene, options, warnings, {});
}

bool has_warning(const std::vector<Warning>& warnings, const std::string& code) {
    return std::any_of(warnings.begin(), warnings.end(), [&](const Warning& w) { return w.code == code; });
}

TEST(Unwrap, GivesEveryTriangleAPlaceOfItsOwn) {
    const Scene scene = mixed_scene();
    for (const double density : {0.0, 20.0, 200.0}) {
        UnwrapOptions options;
        options.texels_per_metre = density;
        options.page_size = 512;
        const Atlas atlas = unwrap_quietly(scene, options);
        expect_sound(scene, atlas);
    }
}

TEST(Unwrap, KeepsTheDensity) {
    Scene scene;
    add_object(scene, "box", test::box(2, 1, 3), 1);
    add_object(scene, "sphere", test::sphere(20, 0.7f), 2);
    UnwrapOptions options;
    options.texels_per_metre = 50;
    const Atlas atlas = unwrap_quietly(scene, options);
    std::vector<double> flat(2), world(2);
    for (std::uint32_t t = 0; t < scene.triangle_count(); ++t) {
        flat[scene.triangle_object[t]] += uv_area(atlas, t);
        world[scene.triangle_object[t]] += scene.area_m2(t) * 2500;
    }
    EXPECT_NEAR(flat[0], world[0], 1e-4 * world[0]);  // flat faces: exact
    EXPECT_NEAR(flat[1], world[1], 1e-2 * world[1]);
    // Whole walls lie straight on the grid.
    for (const Chart& chart : atlas.charts)
        if (chart.object == 0) {
            EXPECT_EQ(chart.width % 50, 0u);
            EXPECT_EQ(chart.height % 50, 0u);
        }
}

TEST(Unwrap, DoesNotDependOnThreads) {
    const Scene scene = mixed_scene();
    UnwrapOptions options;
    options.piece_triangles = 300;  // many pieces
    Atlas one, two;
    {
        const ThreadLimit limit(1);
        one = unwrap_quietly(scene, options);
    }
    {
        const ThreadLimit limit(2);
        two = unwrap_quietly(scene, options);
    }
    EXPECT_EQ(one.corner_uv, two.corner_uv);
    EXPECT_EQ(one.chart_triangles, two.chart_triangles);
    ASSERT_EQ(one.charts.size(), two.charts.size());
    for (std::size_t c = 0; c < one.charts.size(); ++c) {
        EXPECT_EQ(one.charts[c].x, two.charts[c].x);
        EXPECT_EQ(one.charts[c].y, two.charts[c].y);
        EXPECT_EQ(one.charts[c].page, two.charts[c].page);
    }
}

TEST(Unwrap, CopiesOfAMeshShareCharts) {
    Scene scene;
    const auto mesh = test::sphere(16, 1);
    add_object(scene, "first", mesh, 7);
    add_object(scene, "turned", mesh, 7, [](const Vec3f& p) { return Vec3f(p.z + 5, p.x, p.y - 3); });
    add_object(
        scene, "mirrored", mesh, 7, [](const Vec3f& p) { return Vec3f(-p.x - 9, p.y, p.z); }, true);
    add_object(scene, "larger", mesh, 7, [](const Vec3f& p) { return p * 2.0f + Vec3f(0, 20, 0); });
    UnwrapOptions options;
    options.texels_per_metre = 30;
    const Atlas atlas = unwrap_quietly(scene, options);
    expect_sound(scene, atlas);
    const std::uint32_t n = scene.objects[0].triangle_count;
    for (std::uint32_t t = 0; t < n; ++t)
        for (std::uint32_t k = 0; k < 3; ++k) {
            EXPECT_EQ(atlas.corner_uv[3 * t + k], atlas.corner_uv[3 * (n + t) + k]);
            EXPECT_EQ(atlas.corner_uv[3 * t + k], atlas.corner_uv[3 * (2 * n + t) + (k ? 3 - k : 0)]);
        }
    double larger = 0, world = 0;
    for (std::uint32_t t = 3 * n; t < 4 * n; ++t) larger += uv_area(atlas, t), world += scene.area_m2(t);
    EXPECT_NEAR(larger / world, 900, 9);  // same content in another size: charts of its own
}

TEST(Unwrap, OtherObjectsDoNotMatter) {
    UnwrapOptions options;
    options.texels_per_metre = 40;
    Scene before, after;
    add_object(before, "changing", test::box(1, 1, 1), 1);
    add_object(before, "sphere", test::sphere(20, 0.7f), 2);
    add_object(after, "changing", test::terrain(50, 0.1f, 0.3f), 9);
    add_object(after, "sphere", test::sphere(20, 0.7f), 2);
    const Atlas a = unwrap_quietly(before, options), b = unwrap_quietly(after, options);
    const std::uint32_t n = before.objects[1].triangle_count;
    for (std::uint32_t i = 0; i < 3 * n; ++i)
        ASSERT_EQ(a.corner_uv[3 * before.objects[1].first_triangle + i],
                  b.corner_uv[3 * after.objects[1].first_triangle + i]);
}

TEST(Unwrap, AnySizeAndPlace) {
    for (const float scale : {1e-4f, 1.0f, 1e6f}) {
        Scene scene;
        add_object(scene, "sphere", test::sphere(12, scale), 1);
        add_object(scene, "far", test::sphere(12, scale), 2, [&](const Vec3f& p) { return p + Vec3f(500 * scale); });
        const Atlas atlas = unwrap_quietly(scene);
        expect_sound(scene, atlas);
        EXPECT_EQ(atlas.page_count, 1u);
        double texels = 0;
        for (std::uint32_t t = 0; t < scene.triangle_count(); ++t) texels += uv_area(atlas, t);
        EXPECT_GT(texels, 0.25 * 1024 * 1024);
        EXPECT_LE(texels, 0.51 * 1024 * 1024);
    }
}

TEST(Unwrap, SliversAndCoincidentFacesGetAPlace) {
    test::MadeMesh mesh = test::box(1, 1, 1);
    const auto base = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), {{0, 0, 5}, {1, 0, 5}, {0.5f, 1e-9f, 5}});
    mesh.triangles.push_back({base, base + 1, base + 2});
    mesh.triangles.push_back({0, 2, 3});  // the same face again
    mesh.triangles.push_back({3, 2, 0});  // and turned over
    Scene scene;
    add_object(scene, "odd", mesh, 1);
    std::vector<Warning> warnings;
    const Atlas atlas = unwrap(scene, {}, warnings, {});
    expect_sound(scene, atlas);
    ASSERT_TRUE(has_warning(warnings, "unwrap-fallback"));
    EXPECT_EQ(warnings[0].where, "odd");
}

TEST(Unwrap, TimeLimitFallsBackWithAWarning) {
    Scene scene;
    add_object(scene, "sphere", test::sphere(20, 1), 1);
    UnwrapOptions options;
    options.piece_time_limit_s = 0;
    std::vector<Warning> warnings;
    const Atlas atlas = unwrap(scene, options, warnings, {});
    expect_sound(scene, atlas);
    EXPECT_TRUE(has_warning(warnings, "unwrap-slow"));
    EXPECT_TRUE(has_warning(warnings, "unwrap-fallback"));
}

TEST(Unwrap, ChartsLargerThanAPageAreSplitOrScaled) {
    Scene scene;
    add_object(scene, "terrain", test::terrain(40, 0.1f, 0), 1);
    UnwrapOptions options;
    options.texels_per_metre = 100;
    options.page_size = 128;
    std::vector<Warning> warnings;
    const Atlas split = unwrap(scene, options, warnings, {});
    expect_sound(scene, split);
    EXPECT_FALSE(has_warning(warnings, "chart-scaled"));
    Scene wall;
    add_object(wall, "wall", test::box(10, 10, 10), 1);
    const Atlas scaled = unwrap(wall, options, warnings, {});
    expect_sound(wall, scaled);
    EXPECT_TRUE(has_warning(warnings, "chart-scaled"));
}

TEST(Unwrap, EmptySceneAndBadOptions) {
    EXPECT_EQ(unwrap_quietly(Scene{}).page_count, 0u);
    const Scene scene = mixed_scene();
    UnwrapOptions options;
    options.page_size = 8;
    EXPECT_THROW(unwrap_quietly(scene, options), Error);
    options = {};
    options.padding = 500;
    EXPECT_THROW(unwrap_quietly(scene, options), Error);
    options = {};
    options.texels_per_metre = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(unwrap_quietly(scene, options), Error);
}

test::MadeMesh quad_with_uv(const std::array<Vec2f, 4>& uv) {
    test::MadeMesh mesh;
    mesh.positions = {{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {0, 1, 0}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    mesh.uv1.assign(uv.begin(), uv.end());
    return mesh;
}

TEST(Unwrap, KeepsASecondUvSet) {
    Scene scene;
    add_object(scene, "kept", quad_with_uv({{{0.5f, 0.25f}, {1, 0.25f}, {1, 0.5f}, {0.5f, 0.5f}}}), 1);
    UnwrapOptions options;
    options.uv_mode = UvMode::keep;
    options.texels_per_metre = 10;
    std::vector<Warning> warnings;
    const Atlas atlas = unwrap(scene, options, warnings, {});
    EXPECT_TRUE(warnings.empty());
    ASSERT_EQ(atlas.charts.size(), 1u);
    EXPECT_EQ(atlas.charts[0].width, 20u);
    EXPECT_EQ(atlas.charts[0].height, 10u);
    EXPECT_NEAR(atlas.corner_uv[1].x, 20, 1e-4);
    EXPECT_NEAR(atlas.corner_uv[2].y, 10, 1e-4);
}

TEST(Unwrap, ReplacesASecondUvSetThatOverlapsOrLeavesTheSquare) {
    for (const float far_corner : {0.0f, 3.0f}) {
        Scene scene;
        // Corner 3 onto corner 1: the second triangle lies on the first. Or far outside.
        const Vec2f last = far_corner > 0 ? Vec2f(0, far_corner) : Vec2f(0.9f, 0);
        add_object(scene, "bad", quad_with_uv({{{0, 0}, {1, 0}, {1, 1}, last}}), 1);
        UnwrapOptions options;
        options.uv_mode = UvMode::keep;
        std::vector<Warning> warnings;
        const Atlas atlas = unwrap(scene, options, warnings, {});
        expect_sound(scene, atlas);
        EXPECT_TRUE(has_warning(warnings, "uv-not-kept"));
    }
}

/// What a warning says of the second UV set of an object; empty: it was kept.
std::string why_not_kept(const Scene& scene) {
    UnwrapOptions options;
    options.uv_mode = UvMode::keep;
    std::vector<Warning> warnings;
    expect_sound(scene, unwrap(scene, options, warnings, {}));
    for (const Warning& warning : warnings)
        if (warning.code == "uv-not-kept") return warning.where + ": " + warning.text;
    return {};
}

TEST(Unwrap, SaysWhereASecondUvSetOverlaps) {
    // Four squares of a row, the last of them on the first but for a half: 4 of 8 triangles share an eighth of the row's area.
    test::MadeMesh mesh;
    for (std::uint32_t k = 0; k < 4; ++k) {
        const auto x = static_cast<float>(k), u = k == 3 ? 0.1f : 0.2f * x;
        const std::uint32_t first = 4 * k;
        for (const auto& [dx, dy] : {std::pair{0.0f, 0.0f}, {1.0f, 0.0f}, {1.0f, 1.0f}, {0.0f, 1.0f}}) {
            mesh.positions.emplace_back(2 * x + dx, dy, 0.0f);
            mesh.uv1.emplace_back(u + (k == 3 ? 0.1f : 0.2f) * dx, 0.5f + (k == 3 ? 0.1f : 0.2f) * dy);
        }
        mesh.triangles.push_back({first, first + 1, first + 2});
        mesh.triangles.push_back({first, first + 2, first + 3});
    }
    Scene scene;
    add_object(scene, "plain", test::box(1, 1, 1), 2);
    add_object(scene, "row", mesh, 1);
    scene.object_has_uv1 = {false, true};
    const std::string text = why_not_kept(scene);
    EXPECT_NE(text.find("row: "), std::string::npos) << text;
    EXPECT_NE(text.find("of 8 triangles overlap others"), std::string::npos) << text;
    // It lies in the right half of the first square.
    double u = 0, v = 0, percent = 0;
    unsigned count = 0;
    const auto at = text.find("at (");
    ASSERT_NE(at, std::string::npos) << text;
    ASSERT_EQ(std::sscanf(text.c_str() + at, "at (%lf, %lf)", &u, &v), 2);
    EXPECT_TRUE(u > 0.1 && u < 0.2 && v > 0.5 && v < 0.6) << text;
    ASSERT_EQ(std::sscanf(text.c_str() + text.find("lightmap: "), "lightmap: %u of", &count), 1) << text;
    EXPECT_EQ(count, 3u) << "the lower triangle of the first square, and both of the last";
    ASSERT_EQ(std::sscanf(text.c_str() + text.find(" on ") + 1, "on %lf %%", &percent), 1) << text;
    EXPECT_NEAR(percent, 100 * 0.01 / 0.12, 1) << text;
}

TEST(Unwrap, ASecondUvSetMayLieInAnyTile) {
    const auto shifted = [](float x, float y) {
        Scene scene;
        add_object(scene, "tile", quad_with_uv({{{x, y}, {x + 1, y}, {x + 1, y + 0.5f}, {x, y + 0.5f}}}), 1);
        return scene;
    };
    for (const auto& [x, y] : {std::pair{0.0f, 0.0f}, {3.0f, 0.25f}, {-2.0f, 7.0f}, {0.0f, -0.5f}}) EXPECT_EQ(why_not_kept(shifted(x, y)), "") << x << ' ' << y;
    const std::string text = why_not_kept(shifted(0.25f, 3));
    EXPECT_NE(text.find("2 of 2 triangles leave the tile 0..1, 3..4"), std::string::npos) << text;
    EXPECT_NE(text.find("at (1.25, 3)"), std::string::npos) << text;
}

TEST(Density, StepsAreCoarse) {
    EXPECT_EQ(automatic_density(100, 1024), automatic_density(101, 1024));
    for (double area = 1e-6; area < 1e9; area *= 3.7) {
        const double density = automatic_density(area, 1024), texels = density * density * area;
        EXPECT_LE(texels, 0.5 * 1024 * 1024 * 1.000001);
        EXPECT_GE(texels, 0.5 * 1024 * 1024 / 1.415);
    }
}

}  // namespace
}  // namespace luxel
