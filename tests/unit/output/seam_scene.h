/// Scenes with seams for the tests of output: quads with charts laid out by hand, light painted on texels, and what a
/// viewer reads on a page.
#pragma once
#include <cmath>
#include <functional>

#include "baker/output/dilate.h"
#include "baker/output/fill_hidden.h"
#include "baker/output/seam_join.h"
#include "baker/patches/fragment_polygon.h"
#include "tests/support/scenes.h"

namespace luxel::test {

/// How the charts of an object lie: texels per metre, and by how much they are turned.
struct FlatLayout {
    double density = 8, turn = 0;
};

/// One chart per object, for objects in planes y = constant: (x, z) turned, scaled and packed in a row of one page.
inline Atlas flat_atlas(const Scene& scene, const std::vector<FlatLayout>& layouts, std::uint32_t page_size = 128,
                        std::uint32_t padding = 2) {
    Atlas atlas;
    atlas.texels_per_metre = static_cast<float>(layouts[0].density);
    atlas.page_size = page_size;
    atlas.page_count = 1;
    atlas.padding = padding;
    atlas.triangle_chart.resize(scene.triangle_count());
    atlas.corner_uv.resize(3 * scene.triangle_count());
    std::uint32_t next_x = padding;
    for (std::uint32_t o = 0; o < scene.objects.size(); ++o) {
        const Object& object = scene.objects[o];
        const FlatLayout& layout = layouts[o];
        const double c = std::cos(layout.turn) * layout.density, s = std::sin(layout.turn) * layout.density;
        double low_u = 1e30, low_v = 1e30, high_u = -1e30, high_v = -1e30;
        const auto place = [&](std::uint32_t t, int k) {
            const Vec3d p = to_double(scene.corner(t, k));
            return std::pair(c * p.x - s * p.z, s * p.x + c * p.z);
        };
        for (std::uint32_t t = object.first_triangle; t < object.first_triangle + object.triangle_count; ++t)
            for (int k = 0; k < 3; ++k) {
                const auto [u, v] = place(t, k);
                low_u = std::min(low_u, u), high_u = std::max(high_u, u), low_v = std::min(low_v, v),
                high_v = std::max(high_v, v);
            }
        Chart chart;
        chart.object = o;
        chart.x = next_x;
        chart.y = padding;
        chart.width = static_cast<std::uint32_t>(std::ceil(high_u - low_u)) + 1;
        chart.height = static_cast<std::uint32_t>(std::ceil(high_v - low_v)) + 1;
        chart.first = static_cast<std::uint32_t>(atlas.chart_triangles.size());
        chart.count = object.triangle_count;
        next_x += chart.width + padding;
        for (std::uint32_t t = object.first_triangle; t < object.first_triangle + object.triangle_count; ++t) {
            atlas.chart_triangles.push_back(t);
            atlas.triangle_chart[t] = o;
            for (int k = 0; k < 3; ++k) {
                const auto [u, v] = place(t, k);
                atlas.corner_uv[std::size_t{3} * t + static_cast<std::size_t>(k)] = {static_cast<float>(u - low_u),
                                                                                     static_cast<float>(v - low_v)};
            }
        }
        atlas.charts.push_back(chart);
    }
    return atlas;
}

/// Scene, charts and texels as the stages before the output leave them. Stays where it is.
struct SeamScene {
    Scene scene;
    Atlas atlas;
    TexelSet texels;
    std::unique_ptr<Tracer> tracer;

    SeamScene(Scene made, Atlas laid_out) : scene(std::move(made)), atlas(std::move(laid_out)) {
        texels = raster_texels(scene, atlas);
        tracer = std::make_unique<Tracer>(scene);
        find_visible_area(scene, atlas, *tracer, 0.5f, texels);
    }
    [[nodiscard]] std::vector<Seam> seams() const { return find_seams(scene, atlas); }
    [[nodiscard]] SeamSamples samples() const { return sample_seams(scene, atlas, texels, *tracer, seams()); }
};

/// All that the unwrapper makes of one object; normals, if given, per vertex.
inline SeamScene unwrapped(const MadeMesh& mesh, const std::vector<Vec3f>& normals = {}, double texels_per_metre = 8,
                           std::uint32_t page_size = 256) {
    SceneMaker maker;
    maker.add("thing", mesh);
    maker.record().meshes[0].primitives[0].normals = normals;
    Scene scene = maker.build();
    UnwrapOptions options;
    options.texels_per_metre = texels_per_metre;
    options.page_size = page_size;
    std::vector<Warning> warnings;
    Atlas atlas = unwrap(scene, options, warnings, {});
    return {std::move(scene), std::move(atlas)};
}

/// Pages with light, filled and grown.
struct LitPages {
    std::uint32_t size = 0;
    std::vector<std::vector<Rgb>> values;
    std::vector<std::vector<std::uint8_t>> masks;

    [[nodiscard]] Rgb read(std::uint32_t page, const Vec2f& at) const {
        const float u = at.x - 0.5f, v = at.y - 0.5f;
        const int x = static_cast<int>(std::floor(u)), y = static_cast<int>(std::floor(v));
        const float fx = u - std::floor(u), fy = v - std::floor(v);
        const auto texel = [&](int column, int row) {
            return values[page][static_cast<std::size_t>(row) * size + static_cast<std::size_t>(column)];
        };
        return (texel(x, y) * (1 - fx) + texel(x + 1, y) * fx) * (1 - fy) +
               (texel(x, y + 1) * (1 - fx) + texel(x + 1, y + 1) * fx) * fy;
    }
};

/// `light` in the world at the centres of gravity of the fragments, their mean by area: exact where it is linear.
inline LitPages paint(const SeamScene& s, const std::function<Rgb(const Vec3f& at, std::uint32_t object)>& light) {
    LitPages pages;
    pages.size = s.atlas.page_size;
    for (const PageTexels& page : s.texels.pages) {
        std::vector<Rgb> values(std::size_t{pages.size} * pages.size, Rgb(0, 0, 0));
        std::vector<std::uint8_t> mask(values.size(), texel_empty);
        std::vector<std::uint32_t> charts(values.size(), none);
        for (const Texel& texel : page.texels) {
            Vec3d sum(0, 0, 0);
            double area = 0;
            for (std::uint32_t f = texel.first_fragment; f < texel.first_fragment + texel.fragment_count; ++f) {
                const Fragment& fragment = page.fragments[f];
                const Vec2f centre = fragment_polygon(s.scene, s.atlas, fragment).centroid();
                const Rgb value = light(surface_position(s.scene, fragment.triangle, centre) + to_float(s.scene.origin),
                                        s.scene.triangle_object[fragment.triangle]);
                sum += to_double(value) * static_cast<double>(fragment.area_m2);
                area += static_cast<double>(fragment.area_m2);
            }
            const std::size_t at = std::size_t{texel.y} * pages.size + texel.x;
            values[at] = to_float(sum / area);
            mask[at] = page.can_send(texel) ? texel_covered : texel_hidden;
            charts[at] = texel.chart;
        }
        fill_hidden(values, mask, charts, pages.size, pages.size);
        dilate(values, mask, pages.size, pages.size, std::max(1u, s.atlas.padding));
        pages.values.push_back(std::move(values));
        pages.masks.push_back(std::move(mask));
    }
    return pages;
}

/// Joins the pages; returns what join_seams() says.
inline SeamJump join(const SeamSamples& samples, LitPages& pages) {
    std::vector<Rgb> values;
    std::vector<SeamTexelKind> kinds;
    const auto at = [&](const SeamTexel& texel) { return std::size_t{texel.y} * pages.size + texel.x; };
    for (const SeamTexel& texel : samples.texels) {
        values.push_back(pages.values[texel.page][at(texel)]);
        const std::uint8_t mask = pages.masks[texel.page][at(texel)];
        kinds.push_back(mask == texel_covered  ? SeamTexelKind::covered
                        : mask == texel_filled ? SeamTexelKind::filled
                                               : SeamTexelKind::empty);
    }
    const SeamJump jump = join_seams(samples, kinds, values);
    for (std::size_t t = 0; t < values.size(); ++t)
        pages.values[samples.texels[t].page][at(samples.texels[t])] = values[t];
    return jump;
}

/// Position in space of a place of a triangle's chart, texels of the page: by barycentrics on the chart.
inline Vec3d position_at(const SeamScene& s, std::uint32_t triangle, const Vec2f& at) {
    const auto uv = [&](int k) { return Vec3d(s.atlas.page_uv(triangle, k).x, s.atlas.page_uv(triangle, k).y, 0); };
    const Vec3d a = uv(1) - uv(0), b = uv(2) - uv(0), p = Vec3d(at.x, at.y, 0) - uv(0);
    const double area = a.x * b.y - a.y * b.x, s1 = (p.x * b.y - p.y * b.x) / area, s2 = (a.x * p.y - a.y * p.x) / area;
    return to_double(s.scene.corner(triangle, 0)) * (1 - s1 - s2) + to_double(s.scene.corner(triangle, 1)) * s1 +
           to_double(s.scene.corner(triangle, 2)) * s2;
}

/// Place on the page of a point in space that lies in a triangle's plane.
inline Vec2f place_of(const SeamScene& s, std::uint32_t triangle, const Vec3d& at) {
    const Vec3d o = to_double(s.scene.corner(triangle, 0)), a = to_double(s.scene.corner(triangle, 1)) - o,
                b = to_double(s.scene.corner(triangle, 2)) - o, p = at - o, n = a.cross(b);
    const double s1 = p.cross(b).dot(n) / n.dot(n), s2 = a.cross(p).dot(n) / n.dot(n);
    return s.atlas.page_uv(triangle, 0) * static_cast<float>(1 - s1 - s2) +
           s.atlas.page_uv(triangle, 1) * static_cast<float>(s1) +
           s.atlas.page_uv(triangle, 2) * static_cast<float>(s2);
}

/// Quad in the plane y, from (x, z) on, fronts up.
inline MadeMesh tile(float x, float z, float wide, float deep, float y = 0) {
    return quad({x, y, z}, {0, 0, deep}, {wide, 0, 0});
}

}  // namespace luxel::test
