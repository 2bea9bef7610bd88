/// Where a texel lies in the world: one point on its surface and the normals there.
/// Threads: pure functions.
#pragma once
#include "baker/patches/fragment_polygon.h"

namespace luxel {

struct TexelSurface {
    std::uint32_t triangle = 0;
    Vec2f barycentric;  ///< weights of corners 1 and 2
    Vec3f position;     ///< m, relative to Scene::origin: centre of gravity of the largest fragment, so on the surface
    Vec3f geometric_normal;  ///< unit, of that fragment's triangle
    Vec3f shading_normal;    ///< unit, interpolated there
};

TexelSurface texel_surface(const Scene& scene, const Atlas& atlas, const PageTexels& page, const Texel& texel);

}  // namespace luxel
