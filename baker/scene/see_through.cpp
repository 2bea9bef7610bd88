#include "baker/scene/see_through.h"

#include <algorithm>

#include "baker/scene/texture_sample.h"

namespace luxel {
namespace {

struct Cover {
    float coverage, opacity;
    Rgb colour;  ///< base colour
};

Cover cover_at(const Scene& scene, const Material& material, std::uint32_t triangle, float b1, float b2) {
    const Rgba base = surface_base(scene, triangle, b1, b2);
    float coverage = 1;
    if (material.alpha_mode != AlphaMode::opaque) coverage = material.alpha * base[3];
    if (material.alpha_mode == AlphaMode::mask) coverage = coverage >= material.alpha_cutoff ? 1.0f : 0.0f;
    float clear = 0;
    if (!scene.object_of(triangle).casts) return {coverage, 0, Rgb(1, 1, 1)};
    if (material.transmission > 0)
        clear = material.transmission * surface_texture(scene, material.transmission_texture, material.transmission_uv_set,
                                                        material.transmission_transform, triangle, b1, b2)[0];
    return {coverage, coverage * (1 - clear), material.pane_colour * Rgb(base[0], base[1], base[2])};
}

}  // namespace

Passage surface_passage(const Scene& scene, std::uint32_t triangle, float b1, float b2) {
    if (!scene.object_of(triangle).casts) return {0, Rgb(1, 1, 1)};
    const Material& material = scene.material_of(triangle);
    const Cover at = cover_at(scene, material, triangle, b1, b2);
    if (at.opacity >= 1) return {};
    const bool colours = material.alpha_mode == AlphaMode::blend && material.blend_colours;
    const Rgb beside = colours ? at.colour : Rgb(1, 1, 1);
    const Rgb passes = beside * (1 - at.coverage) + at.colour * (at.coverage - at.opacity);
    // Nothing tints a clear hole, however the sum is rounded.
    if (at.coverage <= at.opacity && !colours) return {at.opacity, Rgb(1, 1, 1)};
    const auto share = [&](float passing) { return std::min(passing / (1 - at.opacity), 1.0f); };
    return {at.opacity, {share(passes.x), share(passes.y), share(passes.z)}};
}

SeeThroughMean mean_see_through(const Scene& scene, std::uint32_t triangle, std::span<const Vec2f> points) {
    const Material& material = scene.material_of(triangle);
    SeeThroughMean mean;
    for (const Vec2f& b : points) {
        const Cover at = cover_at(scene, material, triangle, b.x, b.y);
        mean.coverage += at.coverage, mean.opacity += at.opacity;
        mean.reflectance += surface_reflectance(scene, triangle, b.x, b.y) * at.opacity;
        mean.emission += surface_emission(scene, triangle, b.x, b.y) * at.opacity;
    }
    if (mean.opacity > 0) mean.reflectance /= mean.opacity, mean.emission /= mean.opacity;
    const auto count = static_cast<float>(points.size());
    mean.coverage /= count, mean.opacity /= count;
    return mean;
}

}  // namespace luxel
