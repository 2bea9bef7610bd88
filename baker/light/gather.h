/// Light at every texel by final gathering: cosine rays bent towards where the texel's patch gets its light (light_guide.h) that
/// read the radiosity where they end (radiosity_detail.h), rays aimed at
/// emitting patches (up to half of all; none where emitters fill the view; the two are combined by multiple importance sampling, so the mean
/// depends on neither), and shadow rays to lamps. A texel's value is the mean over the part of its square that the
/// surface covers and that does not lie inside a solid; 0 where all of it does.
/// Source: Cohen, Greenberg, Immel, Brock, An Efficient Radiosity Approach for Realistic Image Synthesis, IEEE CG&A 6(3)
/// 1986 (patches shoot, elements receive); Reichert, A Two-Pass Radiosity Method, 1992 (final gather).
#pragma once
#include <optional>
#include <span>
#include <vector>

#include "baker/core/progress.h"
#include "baker/core/stop.h"
#include "baker/light/emitters.h"
#include "baker/light/light_guide.h"
#include "baker/light/radiosity_detail.h"
#include "baker/patches/patch.h"
#include "baker/trace/tracer.h"
#include "baker/unwrap/atlas.h"

namespace luxel {

struct GatherOptions {
    std::uint32_t rays = 64;         ///< per texel, a power of two, at least 4; cosine and aimed ones together
    bool aim_at_emitters = true;     ///< false: cosine rays only
    std::uint32_t lamp_points = 4;   ///< points of the texel at which lamps are tested, a power of two
    std::uint32_t edge_lamp_points = 0;  ///< the same where a shadow may have its edge (texel_lamps.h); 0: no more than elsewhere
    float near_m = 0;                ///< hits closer than this are followed on (near_light.h), m; 0: patches always serve
    std::uint64_t seed = 0;
    const StopRequest* stop = nullptr;  ///< looked at before each texel
};

class Sky;

struct GatherInput {
    const Scene& scene;
    const Atlas& atlas;
    const TexelSet& texels;
    const PatchSet& patches;
    const Tracer& tracer;
    const EmitterSet& emitters;
    const RadiosityDetail& radiosity;  ///< without self-emission
    const LightGuides& guides;         ///< empty: plain cosine rays
    const Sky* sky = nullptr;          ///< null: there is none, or nothing sees it
    std::span<const std::uint8_t> dark{};  ///< per patch: not 0 where no light comes to (accuracy/dark_patches.h): its texels cast no rays; empty: none is
};

/// Two estimates per texel from independent halves of its rays, lux: their mean is the estimate, their difference shows its noise.
struct GatheredLight {
    std::array<std::vector<Rgb>, 2> halves;
};

/// Irradiance H of each texel of a page, in the order of its texels, by where the light comes from.
struct GatheredPage {
    std::vector<Rgb> lamps;            ///< lux; no noise worth naming
    GatheredLight emitted, reflected;  ///< straight from the sky and from surfaces that shine; by way of others
    std::vector<std::uint32_t> rays;   ///< TexelLight::rays

    /// Of a texel, without lamps.
    [[nodiscard]] Rgb gathered(std::size_t texel) const {
        return (emitted.halves[0][texel] + emitted.halves[1][texel] + reflected.halves[0][texel] + reflected.halves[1][texel]) * 0.5f;
    }
    /// The sum of all, as gathered.
    [[nodiscard]] std::vector<Rgb> irradiance() const;
};

/// A pure function of geometry, light and options: neither pages nor threads change the points. Adds texels to `progress`.
/// Nothing when it was asked to stop before the page was done.
std::optional<GatheredPage> gather_page(const GatherInput& input, std::uint32_t page, const GatherOptions& options,
                                        ProgressCounter* progress);

/// As many rays again for some texels as each has had so far: what they find goes into the mean. `chosen`: their indexes, each once;
/// `doublings`: per texel of the page, how often this was done to it, counted up here. Lamps stay as they are. False when it was asked
/// to stop: then `light` is of no use.
bool double_rays(const GatherInput& input, std::uint32_t page, const GatherOptions& options, std::span<const std::uint32_t> chosen,
                 std::span<std::uint8_t> doublings, GatheredPage& light);

}  // namespace luxel
