#include "baker/patches/texel_means.h"

#include <algorithm>

#include "baker/patches/fragment_polygon.h"
#include "baker/patches/see_through_texels.h"
#include "baker/scene/texture_sample.h"

namespace luxel {
namespace {

/// The texture is averaged over the fragment's bounding box on the page.
SurfaceFootprint footprint_of(const Scene& scene, const Atlas& atlas, const Fragment& fragment) {
    const FragmentPolygon polygon(scene, atlas, fragment);
    SurfaceFootprint footprint;
    footprint.b1 = polygon.centroid().x;
    footprint.b2 = polygon.centroid().y;
    Vec2f low = polygon.centroid(), high = low;
    for (const Vec2f& corner : polygon.corners()) {
        low = {std::min(low.x, corner.x), std::min(low.y, corner.y)};
        high = {std::max(high.x, corner.x), std::max(high.y, corner.y)};
    }
    if (polygon.is_square()) {
        footprint.side_s = polygon.corners()[1] - polygon.corners()[0];
        footprint.side_t = polygon.corners()[3] - polygon.corners()[0];
        return footprint;
    }
    footprint.side_s = {high.x - low.x, 0};
    footprint.side_t = {0, high.y - low.y};
    return footprint;
}

}  // namespace

void average_texel(const Scene& scene, const Atlas& atlas, const PageTexels& page, Texel& texel) {
    const std::uint32_t end = texel.first_fragment + texel.fragment_count;
    double area = 0, visible = 0, weights = 0;
    for (std::uint32_t f = texel.first_fragment; f < end; ++f) {
        area += static_cast<double>(page.fragments[f].area_m2);
        visible += static_cast<double>(page.fragments[f].visible_m2());
    }
    Vec3d reflectance(0), emission(0);
    for (std::uint32_t f = texel.first_fragment; f < end; ++f) {
        const Fragment& fragment = page.fragments[f];
        const double weight = static_cast<double>(visible > 0 ? fragment.visible_m2() : fragment.area_m2);
        if (weight <= 0) continue;
        const Material& material = scene.material_of(fragment.triangle);
        weights += weight;
        if (scene.is_see_through(fragment.triangle)) {
            const SeeThroughMean mean = fragment_passage(scene, atlas, fragment).mean;
            reflectance += to_double(mean.reflectance) * weight;
            emission += to_double(mean.emission) * weight;
            continue;
        }
        const bool is_varied = has_varied_base(scene, fragment.triangle), varies = is_varied || material.emissive_texture != none;
        const SurfaceFootprint footprint = varies ? footprint_of(scene, atlas, fragment) : SurfaceFootprint{};
        const Rgb rho = is_varied ? mean_reflectance(scene, fragment.triangle, footprint) : surface_reflectance(scene, fragment.triangle, 0, 0);
        const Rgb exitance = material.emissive_texture != none ? mean_emission(scene, fragment.triangle, footprint)
                                                               : surface_emission(scene, fragment.triangle, 0, 0);
        reflectance += to_double(rho) * weight;
        emission += to_double(exitance) * weight;
    }
    texel.area_m2 = static_cast<float>(area);
    texel.visible_m2 = static_cast<float>(visible);
    texel.reflectance = to_float(reflectance / weights);
    texel.emission = to_float(emission / weights);
}

}  // namespace luxel
