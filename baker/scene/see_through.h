/// What of the light that arrives at a point of a surface passes through it, straight on, and in which colour.
///
/// A surface covers its alpha a: 1 for OPAQUE, 0 or 1 by the cutoff for MASK, the alpha itself for BLEND. What does not cover is
/// clear, or takes the base colour (BLEND, with Material::blend_colours). Of what covers, the share t of
/// KHR_materials_transmission is a thin pane that takes the base colour; the rest is the diffuse surface. So per channel
///
///     opacity = a (1 - t)                                    meets the surface, which reflects its base colour
///     passes  = (1 - a) [base colour] + a t base colour      <= 1 - opacity
///
/// Panes are infinitely thin: nothing is refracted, and a box of glass is two of them for a ray. Both sides of a surface pass
/// the same. Threads: pure functions. Errors: none.
/// Source: glTF 2.0 specification, section 3.9.4 (alpha is coverage); KHR_materials_transmission (thin, tinted by base colour).
#pragma once
#include <span>

#include "baker/scene/scene.h"

namespace luxel {

struct Passage {
    float opacity = 1;    ///< 0..1: the chance that a ray meets the surface
    Rgb tint{1, 1, 1};    ///< 0..1: what is left of the light that does not, so that (1 - opacity) * tint passes
    [[nodiscard]] Rgb passes() const { return tint * (1 - opacity); }
    /// Nothing is there.
    [[nodiscard]] bool is_hole() const { return opacity <= 0 && tint == Rgb(1, 1, 1); }
};

Passage surface_passage(const Scene& scene, std::uint32_t triangle, float b1, float b2);

/// Means over points of a surface that can be seen through, (b1, b2) each; at least one.
struct SeeThroughMean {
    float coverage = 0, opacity = 0;  ///< 0..1
    Rgb reflectance{0, 0, 0};  ///< of the surface that is met: weighted by opacity; 0 where nothing is
    Rgb emission{0, 0, 0};     ///< the same, lm/m2: opacity times emission is what an area sends
};
SeeThroughMean mean_see_through(const Scene& scene, std::uint32_t triangle, std::span<const Vec2f> points);

}  // namespace luxel
