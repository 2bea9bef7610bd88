#include "baker/light/pane_colour.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "baker/core/parallel.h"
#include "baker/core/sampling.h"
#include "baker/core/sobol.h"
#include "baker/light/light_sum.h"
#include "baker/patches/patch_sampler.h"
#include "baker/core/ray_offset.h"
#include "baker/trace/surface_map.h"

namespace luxel {
namespace {

constexpr std::size_t batch = SobolSequence::batch;
constexpr std::uint64_t purpose = 0x636f6c6f7572;  // separates these rays from those of the evidence

class PaneColours {
  public:
    PaneColours(const PaneColourInput& input, const PaneColourOptions& options) : in_(input), options_(options) {}

    /// One more step for one patch.
    [[nodiscard]] Rgb next(PatchNumber patch, std::span<const Rgb> colours) const {
        const PatchSampler sampler(in_.scene, in_.atlas, in_.patches, patch);
        const SobolSequence sequence(mix(mix(in_.patches.patches[patch].id, purpose), options_.seed));
        LightSum coloured, grey;
        std::array<TraceRay, batch> rays;
        std::array<TraceHit, batch> hits;
        for (std::uint32_t begin = 0; begin < options_.rays; begin += batch) {
            for (std::uint32_t k = 0; k < batch; ++k) {
                const auto u = sequence.point(begin + k);
                const SurfacePoint at = sampler.point(u[0], u[1]);
                rays[k] = {offset_origin(at.position, at.normal, in_.scene.corner_extent(at.triangle)),
                           Frame(at.normal).to_world(cosine_direction(u[2], u[3])), at.triangle};
            }
            in_.tracer.first_hits(rays, hits);
            for (const TraceHit& hit : hits) {
                const Landing at = landing(in_.scene, in_.atlas, in_.patches, hit);
                if (at.end != RayEnd::patch) continue;
                const Patch& met = in_.patches.patches[at.patch];
                const Rgb& reflected = in_.reflected[at.patch];
                const float mean = (hit.tint.x + hit.tint.y + hit.tint.z) / 3;
                coloured.add(met.emission + recoloured(reflected, lamps(at.patch), colours[at.patch]), hit.tint);
                grey.add(met.emission + reflected, mean);
            }
        }
        const Rgb up = coloured.rgb(), down = grey.rgb();
        const auto ratio = [&](int c) { return down[c] > 0 ? up[c] / down[c] : 1.0f; };
        return {ratio(0), ratio(1), ratio(2)};
    }

  private:
    [[nodiscard]] Rgb lamps(PatchNumber patch) const {
        return in_.patches.patches[patch].reflectance * in_.lamp_irradiance[patch];
    }

    const PaneColourInput& in_;
    const PaneColourOptions& options_;
};

/// Changes that shrink by a factor q per channel from step to step: the last one is to be followed by q + q^2 + ... of itself.
struct Series {
    Rgb sum{1, 1, 1};  ///< 1 + q + q^2 + ...
    double rest = 0;   ///< mean size of what follows, in the worst channel
};

Series series_of(std::span<const Rgb> change, std::span<const Rgb> before) {
    constexpr double most = 0.95;  // a factor near one is noise, and would go anywhere
    Series series;
    for (int c = 0; c < 3; ++c) {
        double both = 0, square = 0, size = 0;
        for (std::size_t p = 0; p < change.size(); ++p) {
            const double now = static_cast<double>(change[p][c]), then = before.empty() ? 0.0 : static_cast<double>(before[p][c]);
            both += now * then, square += then * then, size += std::fabs(now);
        }
        const double q = square > 0 ? std::clamp(both / square, 0.0, most) : 0.0;
        series.sum[c] = static_cast<float>(1 / (1 - q));
        series.rest = std::max(series.rest, size / static_cast<double>(change.size()) * q / (1 - q));
    }
    return series;
}

}  // namespace

bool has_tinting_panes(const Scene& scene) {
    return std::any_of(scene.objects.begin(), scene.objects.end(), [&](const Object& object) {
        const Material& m = scene.materials[object.material];
        const bool takes_colour = m.transmission > 0 || (m.alpha_mode == AlphaMode::blend && m.blend_colours);
        const bool is_grey = m.base_texture == none && !object.is_painted() && m.pane_colour == Rgb(m.pane_colour.x, m.pane_colour.x, m.pane_colour.x);
        return object.casts && takes_colour && !is_grey;
    });
}

std::vector<Rgb> pane_colours(const PaneColourInput& input, const PaneColourOptions& options) {
    if (!has_tinting_panes(input.scene)) return {};
    const PaneColours pane(input, options);
    std::vector<Rgb> colours(input.patches.count(), Rgb(1, 1, 1)), change(colours.size()), before;
    for (std::uint32_t step = 0; step < options.most_steps; ++step) {
        if (options.stop && options.stop->is_asked()) break;
        parallel_for(colours.size(), 16, [&](std::size_t p) {
            change[p] = pane.next(static_cast<PatchNumber>(p), colours) - colours[p];
        });
        const Series series = series_of(change, before);
        const bool go_on = !before.empty() && step % 3 == 2;
        for (std::size_t p = 0; p < colours.size(); ++p)
            for (int c = 0; c < 3; ++c) colours[p][c] = std::max(colours[p][c] + change[p][c] * (go_on ? series.sum[c] : 1.0f), 0.0f);
        if (!before.empty() && series.rest < options.tolerance) break;
        if (go_on) before.clear();
        else before = change;
    }
    return colours;
}

}  // namespace luxel
