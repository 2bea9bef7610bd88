#include "baker/patches/see_through_texels.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "baker/core/parallel.h"
#include "baker/patches/fragment_polygon.h"
#include "baker/patches/texel_means.h"
#include "baker/scene/texture_sample.h"

namespace luxel {
namespace {

/// Points along a side of a cell: one where nothing varies.
constexpr int most_points = 4;

/// Pixels of the texture that the polygon reaches over, along the longer side.
double pixels_across(const Scene& scene, std::uint32_t texture, int uv_set, const std::array<float, 6>& m,
                     const FragmentPolygon& polygon, std::uint32_t triangle) {
    if (texture == none) return 0;
    std::array<double, 2> low{1e30, 1e30}, high{-1e30, -1e30};
    for (const Vec2f& b : polygon.corners()) {
        const Vec2f uv = surface_uv(scene, triangle, uv_set, b.x, b.y);
        const std::array<double, 2> at{static_cast<double>(m[0] * uv.x + m[1] * uv.y), static_cast<double>(m[3] * uv.x + m[4] * uv.y)};
        for (std::size_t k = 0; k < 2; ++k) low[k] = std::min(low[k], at[k]), high[k] = std::max(high[k], at[k]);
    }
    const Texture& pixels = scene.textures[texture];
    return std::max((high[0] - low[0]) * pixels.width, (high[1] - low[1]) * pixels.height);
}

int points_along_cell(const Scene& scene, const FragmentPolygon& polygon, std::uint32_t triangle) {
    const Material& material = scene.material_of(triangle);
    const double pixels = std::max({
        pixels_across(scene, material.base_texture, material.base_uv_set, material.base_transform, polygon, triangle),
        pixels_across(scene, material.transmission_texture, material.transmission_uv_set, material.transmission_transform, polygon, triangle),
        pixels_across(scene, material.emissive_texture, material.emissive_uv_set, material.emissive_transform, polygon, triangle)});
    // Between vertices alpha is linear, but a mask has its edge anywhere.
    if (material.alpha_mode == AlphaMode::mask && scene.object_of(triangle).is_painted()) return most_points;
    // Two for each pixel: a mask's edge lies anywhere in one.
    return pixels > 0 ? std::clamp(static_cast<int>(std::ceil(std::min(2 * pixels, 1e6) / cells_across)), 2, most_points) : 1;
}

}  // namespace

FragmentPassage fragment_passage(const Scene& scene, const Atlas& atlas, const Fragment& fragment) {
    const FragmentPolygon polygon(scene, atlas, fragment);
    const int side = points_along_cell(scene, polygon, fragment.triangle);
    const VisibleCells cells = fragment.visible ? fragment.visible : all_visible;
    FragmentPassage passage;
    std::vector<Vec2f> points;
    for (std::uint32_t cell = 0; cell < cells_across * cells_across; ++cell) {
        if (!(cells >> cell & 1)) continue;
        const auto begin = static_cast<std::ptrdiff_t>(points.size());
        for (int t = 0; t < side; ++t)
            for (int s = 0; s < side; ++s) {
                const auto place = [&](std::uint32_t first, int k) {
                    return (static_cast<float>(first) + (static_cast<float>(k) + 0.5f) / static_cast<float>(side)) / cells_across;
                };
                points.push_back(polygon.point(place(cell % cells_across, s), place(cell / cells_across, t)));
            }
        const bool is_covered = std::any_of(points.begin() + begin, points.end(), [&](const Vec2f& b) {
            return surface_alpha(scene, fragment.triangle, b.x, b.y) > 0;
        });
        if (is_covered) passage.covered = static_cast<VisibleCells>(passage.covered | (1u << cell));
    }
    passage.mean = mean_see_through(scene, fragment.triangle, points);
    return passage;
}

void thin_see_through(const Scene& scene, const Atlas& atlas, TexelSet& texels) {
    const bool any = std::any_of(scene.objects.begin(), scene.objects.end(),
                                 [&](const Object& o) { return !o.casts || scene.materials[o.material].is_see_through(); });
    if (!any) return;
    for (PageTexels& page : texels.pages)
        parallel_for(page.texels.size(), 256, [&](std::size_t t) {
            Texel& texel = page.texels[t];
            bool changed = false;
            for (std::uint32_t f = texel.first_fragment; f < texel.first_fragment + texel.fragment_count; ++f) {
                Fragment& fragment = page.fragments[f];
                if (fragment.visible_parts == 0 || !scene.is_see_through(fragment.triangle)) continue;
                const FragmentPassage passage = fragment_passage(scene, atlas, fragment);
                fragment.visible = static_cast<VisibleCells>(fragment.visible & passage.covered);
                const float parts = static_cast<float>(fragment.visible_parts) * passage.mean.opacity;
                fragment.visible_parts = static_cast<std::uint16_t>(std::max(std::lround(parts), fragment.visible ? 1l : 0l));
                changed = true;
            }
            if (changed) average_texel(scene, atlas, page, texel);
        });
}

}  // namespace luxel
