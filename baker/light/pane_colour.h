/// The colour that panes give to the light between patches. Counts of rays know no colour: the exchange of two patches is
/// dimmed by the mean of what a pane lets through (formfactors/ray_estimator.h). So the solved light is as bright as it should be, the
/// mean over channels of white light at least, but grey. This puts the colour back, patch by patch:
///
///     C_i = sum over rays of tint B C / sum over the same rays of mean(tint) B        per channel
///
/// with B of the patch that the ray meets, of which only what the solve has found (not what it emits, nor what it reflects of lamps, whose
/// colours are right) is multiplied by its own C. Where a ray sees no pane, both sums are the same, so the ratio has no noise of
/// its own. Repeated from C = 1 with the same rays; each time one more bounce has its colour, and the limit is the coloured
/// equation, up to the noise of the rays. Every third step goes on along its own direction by the geometric series that the two
/// before show (Aitken's extrapolation, one factor for all patches), until what is left is below `tolerance`.
#pragma once
#include <span>
#include <vector>

#include "baker/core/stop.h"
#include "baker/patches/patch.h"
#include "baker/trace/tracer.h"
#include "baker/unwrap/atlas.h"

namespace luxel {

struct PaneColourOptions {
    std::uint32_t rays = 256;  ///< per patch and step, a multiple of 64
    std::uint32_t most_steps = 24;
    double tolerance = 2e-3;  ///< of C, on average over patches, in the worst channel
    std::uint64_t seed = 0;
    const StopRequest* stop = nullptr;  ///< looked at before each step: then colours are as far as they have come
};

struct PaneColourInput {
    const Scene& scene;
    const Atlas& atlas;
    const PatchSet& patches;
    const Tracer& tracer;
    std::span<const Rgb> reflected;        ///< B - M per patch, lm/m2
    std::span<const Rgb> lamp_irradiance;  ///< per patch, lux: its part of what is reflected keeps its colour
};

/// Does anything in the scene colour the light that it lets through? Clear and grey panes do not.
bool has_tinting_panes(const Scene& scene);

/// Kept per patch where there are such panes. While it is found it takes three times that.
constexpr std::uint64_t pane_colour_bytes_per_patch = sizeof(Rgb);

/// C per patch; empty where nothing in the scene tints. Threads: uses them all; a pure function of its input.
std::vector<Rgb> pane_colours(const PaneColourInput& input, const PaneColourOptions& options);

/// `light` of which the part `lamps` keeps its colour.
inline Rgb recoloured(const Rgb& light, const Rgb& lamps, const Rgb& colour) {
    const auto part = [&](int c) { return light[c] > lamps[c] ? lamps[c] + (light[c] - lamps[c]) * colour[c] : light[c]; };
    return {part(0), part(1), part(2)};
}

}  // namespace luxel
