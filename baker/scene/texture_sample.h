/// Texture look-ups: what colour a surface has at a point, or on average over a small area.
///
/// uv         glTF's: u right, v down, (0, 0) the upper left corner of the upper left pixel; any value, wrapped.
/// Vertex colours multiply base colour and alpha, linearly between the vertices.
/// b1, b2     barycentric weights of corners 1 and 2 of a triangle; corner 0 has 1 - b1 - b2.
/// returns    linear; reflectance 0..1, emission in lm/m2; alpha is what covers: 1 for OPAQUE, 0 or 1 for MASK, 0..1 for BLEND.
/// Threads    pure functions.
/// Source     glTF 2.0 specification, section 3.8.4 (samplers); KHR_texture_transform.
#pragma once
#include <array>

#include "baker/scene/scene.h"

namespace luxel {

/// Bilinear or nearest value at uv. White for a texture without pixels and for uv that is not finite.
Rgba sample_texture(const Texture& texture, Vec2f uv);

/// Mean over the parallelogram uv + s * du + t * dv, s and t in [-1/2, 1/2]: a fixed grid of samples, as many as the
/// footprint has pixels along each side, at most 8 x 8.
Rgba sample_texture_mean(const Texture& texture, Vec2f uv, Vec2f du, Vec2f dv);

/// uv of a set (0 or 1; others count as zero) at a point of a triangle.
Vec2f surface_uv(const Scene& scene, std::uint32_t triangle, int uv_set, float b1, float b2);

/// Value of a texture as a material uses it at a point of a triangle; white for `texture` none.
Rgba surface_texture(const Scene& scene, std::uint32_t texture, int uv_set, const std::array<float, 6>& transform,
                     std::uint32_t triangle, float b1, float b2);

/// What multiplies a material's own base colour and alpha there: texture times colour of the vertices.
Rgba surface_base(const Scene& scene, std::uint32_t triangle, float b1, float b2);
/// Is there either of them on a triangle's object?
bool has_varied_base(const Scene& scene, std::uint32_t triangle);

/// 0 on an object that receives no light, here and below.
Rgb surface_reflectance(const Scene& scene, std::uint32_t triangle, float b1, float b2);
Rgb surface_emission(const Scene& scene, std::uint32_t triangle, float b1, float b2);
float surface_alpha(const Scene& scene, std::uint32_t triangle, float b1, float b2);

/// A parallelogram on a triangle: a point (b1, b2) and its two sides in the same coordinates.
struct SurfaceFootprint {
    float b1 = 0, b2 = 0;
    Vec2f side_s{0, 0}, side_t{0, 0};  ///< change of (b1, b2) along each side
};

/// Means over the part of the surface that a texel covers. They may reach a little beyond the triangle: textures go on.
Rgb mean_reflectance(const Scene& scene, std::uint32_t triangle, const SurfaceFootprint& footprint);
Rgb mean_emission(const Scene& scene, std::uint32_t triangle, const SurfaceFootprint& footprint);

}  // namespace luxel
