// Texels: exact areas, one chart per texel, the same for any number of threads.
#include "baker/patches/texel_raster.h"

#include <gtest/gtest.h>

#include "baker/core/parallel.h"
#include "baker/patches/texel_surface.h"
#include "baker/unwrap/unwrap.h"
#include "tests/unit/unwrap/made_scene.h"

namespace luxel {
namespace {

Atlas unwrapped(const Scene& scene, double density) {
    UnwrapOptions options;
    options.texels_per_metre = density;
    options.page_size = 256;
    std::vector<Warning> warnings;
    return unwrap(scene, options, warnings, {});
}

std::vector<double> object_areas(const Scene& scene, const TexelSet& set) {
    std::vector<double> areas(scene.objects.size(), 0);
    for (const PageTexels& page : set.pages)
        for (const Fragment& f : page.fragments) areas[scene.triangle_object[f.triangle]] += f.area_m2;
    return areas;
}

void expect_exact_areas(const Scene& scene, const TexelSet& set) {
    const std::vector<double> areas = object_areas(scene, set);
    for (std::size_t o = 0; o < areas.size(); ++o) {
        double expected = 0;
        for (std::uint32_t i = 0; i < scene.objects[o].triangle_count; ++i)
            expected += scene.area_m2(scene.objects[o].first_triangle + i);
        EXPECT_NEAR(areas[o], expected, 1e-6 * expected) << scene.objects[o].name;
    }
}

test::MadeMesh slivers() {
    test::MadeMesh mesh;
    for (std::uint32_t i = 0; i < 20; ++i) {
        const float y = static_cast<float>(i) * 0.3f, thin = std::ldexp(1.0f, -static_cast<int>(i));
        mesh.positions.insert(mesh.positions.end(), {{0, y, 0}, {3, y, 1}, {1, y, thin}});
        mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    return mesh;
}

TEST(TexelRaster, AreasAreExact) {
    for (const float scale : {1e-3f, 1.0f, 1e5f}) {
        Scene scene;
        const auto place = [&](const Vec3f& p) { return p * scale; };
        test::add_object(scene, "box", test::box(2, 1, 3), 1, place);
        test::add_object(scene, "sphere", test::sphere(24, 0.7f), 2, place);
        test::add_object(scene, "terrain", test::terrain(30, 0.05f, 2.0f), 3, place);
        test::add_object(scene, "slivers", slivers(), 4, place);
        for (const double density : {0.3, 7.0, 61.0})
            expect_exact_areas(scene, raster_texels(scene, unwrapped(scene, density / scale)));
    }
}

TEST(TexelRaster, TrianglesWithoutAreaOnThePageKeepTheirArea) {
    Scene scene;
    test::add_object(scene, "box", test::box(2, 1, 3), 1);
    Atlas atlas = unwrapped(scene, 10);
    const auto first = [&](std::uint32_t t) { return &atlas.corner_uv[3 * t]; };
    const auto chart_of = [&](std::uint32_t t) -> const Chart& { return atlas.charts[atlas.triangle_chart[t]]; };
    for (int k = 0; k < 3; ++k) first(0)[k] = {2.5f, 3.5f};                                // a point
    for (int k = 0; k < 3; ++k) first(1)[k] = {static_cast<float>(chart_of(1).width), 0};  // a far corner
    for (int k = 0; k < 3; ++k) first(2)[k] = {1 + 0.75f * static_cast<float>(k), 2.5f};   // a line
    for (int k = 0; k < 3; ++k) first(3)[k] = {4, static_cast<float>(k)};                  // on a grid line
    for (int k = 0; k < 3; ++k)
        first(4)[k] = {static_cast<float>(k), static_cast<float>(k) * 0.99999f};  // nearly a line
    for (int k = 0; k < 3; ++k) first(5)[k] = {3.0f + (k == 1 ? 1e-7f : 0), 1.2f + 3e-8f * static_cast<float>(k)};
    expect_exact_areas(scene, raster_texels(scene, atlas));
}

TEST(TexelRaster, TexelsAreInOrderAndWhole) {
    Scene scene;
    test::add_object(scene, "box", test::box(2, 1, 3), 1);
    test::add_object(scene, "sphere", test::sphere(24, 0.7f), 2);
    const Atlas atlas = unwrapped(scene, 40);
    const TexelSet set = raster_texels(scene, atlas);
    ASSERT_EQ(set.pages.size(), atlas.page_count);
    EXPECT_GT(set.texel_count(), 40000u);
    for (const PageTexels& page : set.pages) {
        std::uint32_t next = 0, last = 0;
        for (const Texel& texel : page.texels) {
            const std::uint32_t at = texel.y * 256u + texel.x;
            EXPECT_TRUE(next == 0 || at > last);
            last = at;
            ASSERT_EQ(texel.first_fragment, next);
            ASSERT_GT(texel.fragment_count, 0u);
            next += texel.fragment_count;
            double area = 0;
            for (std::uint32_t f = texel.first_fragment; f < next; ++f) {
                const Fragment& fragment = page.fragments[f];
                EXPECT_EQ(fragment.x, texel.x);
                EXPECT_EQ(fragment.y, texel.y);
                EXPECT_EQ(atlas.triangle_chart[fragment.triangle], texel.chart) << "two charts in one texel";
                if (f > texel.first_fragment) {
                    EXPECT_GT(fragment.triangle, page.fragments[f - 1].triangle);
                }
                area += fragment.area_m2;
            }
            EXPECT_NEAR(texel.area_m2, area, 1e-6 * area);
            EXPECT_LT(texel.area_m2, 2.0 / 1600) << "more than fits on a texel";
            EXPECT_EQ(texel.reflectance, Rgb(1));
        }
        EXPECT_EQ(next, page.fragments.size());
    }
}

TEST(TexelRaster, DoesNotDependOnThreads) {
    Scene scene;
    test::add_object(scene, "terrain", test::terrain(60, 0.05f, 0.5f), 3);
    const Atlas atlas = unwrapped(scene, 40);
    TexelSet sets[2];
    for (unsigned threads : {1u, 2u}) {
        const ThreadLimit limit(threads);
        sets[threads - 1] = raster_texels(scene, atlas);
    }
    for (std::size_t p = 0; p < sets[0].pages.size(); ++p) {
        const auto &a = sets[0].pages[p].fragments, &b = sets[1].pages[p].fragments;
        ASSERT_EQ(a.size(), b.size());
        for (std::size_t f = 0; f < a.size(); ++f)
            ASSERT_TRUE(a[f].triangle == b[f].triangle && a[f].x == b[f].x && a[f].y == b[f].y &&
                        a[f].area_m2 == b[f].area_m2);
    }
}

TEST(TexelSurface, LiesOnTheSurface) {
    Scene scene;
    test::add_object(scene, "sphere", test::sphere(32, 1), 2);
    const Atlas atlas = unwrapped(scene, 20);
    const TexelSet set = raster_texels(scene, atlas);
    for (const PageTexels& page : set.pages)
        for (const Texel& texel : page.texels) {
            const TexelSurface surface = texel_surface(scene, atlas, page, texel);
            EXPECT_NEAR(surface.position.length(), 1, 0.01);
            EXPECT_GT(surface.geometric_normal.dot(surface.position), 0.99f);
            EXPECT_GT(surface.shading_normal.dot(surface.position.normalized()), 0.995f);
            EXPECT_NEAR(surface.shading_normal.length(), 1, 1e-5);
        }
}

}  // namespace
}  // namespace luxel
