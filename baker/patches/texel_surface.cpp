#include "baker/patches/texel_surface.h"

namespace luxel {

TexelSurface texel_surface(const Scene& scene, const Atlas& atlas, const PageTexels& page, const Texel& texel) {
    const Fragment* largest = &page.fragments[texel.first_fragment];
    for (std::uint32_t f = 1; f < texel.fragment_count; ++f) {
        const Fragment& fragment = page.fragments[texel.first_fragment + f];
        if (fragment.area_m2 > largest->area_m2) largest = &fragment;
    }
    TexelSurface surface;
    surface.triangle = largest->triangle;
    surface.barycentric = fragment_polygon(scene, atlas, *largest).centroid();
    surface.position = surface_position(scene, surface.triangle, surface.barycentric);
    surface.geometric_normal = scene.geometric_normal(surface.triangle);
    surface.shading_normal = shading_normal(scene, surface.triangle, surface.barycentric);
    return surface;
}

}  // namespace luxel
