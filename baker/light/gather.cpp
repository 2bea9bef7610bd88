#include "baker/light/gather.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "baker/core/parallel.h"
#include "baker/core/sampling.h"
#include "baker/core/sobol.h"
#include "baker/core/units.h"
#include "baker/trace/surface_map.h"
#include "baker/light/lamps.h"
#include "baker/light/light_sum.h"
#include "baker/light/near_light.h"
#include "baker/light/sky_gather.h"
#include "baker/patches/patch_sampler.h"
#include "baker/trace/ray_offset.h"

namespace luxel {
namespace {

constexpr std::size_t batch_rays = SobolSequence::batch;

/// One batch of rays of a texel. Only the first `count` entries are rays; others were below the surface.
struct TexelRays {
    std::array<TraceRay, batch_rays> rays;
    std::array<TraceHit, batch_rays> hits;
    std::array<float, batch_rays> cosine;            ///< against the shading normal
    std::array<std::uint32_t, batch_rays> number;    ///< of the texel's rays
    std::array<EmitterSet::Aim, batch_rays> target;  ///< of aimed rays
    std::size_t count = 0;
};

class TexelGather {
  public:
    TexelGather(const GatherInput& input, std::uint32_t page, const GatherOptions& options)
        : in_(input), page_(input.texels.pages[page]), options_(options), lamps_(input.scene, input.tracer) {}

    [[nodiscard]] Rgb irradiance(std::size_t index) const {
        const Texel& texel = page_.texels[index];
        if (!page_.can_send(texel)) return Rgb(0, 0, 0);
        const SurfaceSampler sampler(in_.scene, in_.atlas,
                                     {page_.fragments.data() + texel.first_fragment, texel.fragment_count}, false);
        const std::uint64_t own_seed = seed(texel);
        const SobolSequence sequence(own_seed);
        return indirect(sampler, sequence, own_seed) + direct(sampler, sequence, own_seed);
    }

  private:
    /// How the rays of a texel are shared out, and where emitters are likely.
    struct Plan {
        std::uint32_t cosine_rays = 0, aimed_rays = 0, sky_rays = 0;
        std::vector<float> probability;  ///< per cluster of emitters
    };

    /// Depends on the chart's object, its own grid and the options only: packing does not change the noise.
    [[nodiscard]] std::uint64_t seed(const Texel& texel) const {
        const Chart& chart = in_.atlas.charts[texel.chart];
        const Object& object = in_.scene.objects[chart.object];
        const std::uint64_t place = (std::uint64_t{texel.y - chart.y} << 32) | (texel.x - chart.x);
        return mix(mix(mix(object.path_hash, chart.ordinal), place), options_.seed ^ 0x746578656cULL);
    }

    [[nodiscard]] Plan plan(const SurfaceSampler& sampler) const {
        Plan plan;
        plan.cosine_rays = options_.rays;
        plan.sky_rays = aimed_sky_rays(in_.sky, options_.rays);
        if (!options_.aim_at_emitters || in_.emitters.empty() || options_.rays < 2) return plan;
        const SurfacePoint middle = sampler.point(0.5f, 0.5f);
        const float seen = in_.emitters.weigh(middle.position, sampler.shading_normal(middle), plan.probability);
        // Cosine rays find large emitters by themselves, with less noise than points on them.
        if (seen > 0 && seen < 0.5f) plan.aimed_rays = options_.rays / (seen < 0.25f ? 2 : 4);
        plan.cosine_rays -= plan.aimed_rays;
        return plan;
    }

    [[nodiscard]] Rgb indirect(const SurfaceSampler& sampler, const SobolSequence& sequence, std::uint64_t own_seed) const {
        const Plan shares = plan(sampler);
        NearLight near(in_, options_.near_m, sampler.point(0.5f, 0.5f).position, shares.aimed_rays > 0, own_seed);
        std::vector<NearVertex> vertices;
        const SobolSequence aims(mix(own_seed, 0x61696d));
        LightSum sum;
        TexelRays batch;
        for (std::uint32_t begin = 0; begin < shares.cosine_rays; begin += batch_rays) {
            cast_cosine(sampler, sequence, begin, std::min<std::uint32_t>(shares.cosine_rays, begin + batch_rays), batch);
            for (std::size_t k = 0; k < batch.count; ++k) add_cosine(batch, k, shares, near, vertices, sum);
            if (!vertices.empty()) near.add(vertices, sum);
        }
        for (std::uint32_t begin = 0; begin < shares.aimed_rays; begin += batch_rays) {
            cast_aimed(sampler, sequence, aims, shares, begin,
                       std::min<std::uint32_t>(shares.aimed_rays, begin + batch_rays), batch);
            for (std::size_t k = 0; k < batch.count; ++k) add_aimed(batch, k, shares, sum);
        }
        if (shares.sky_rays) add_aimed_sky(in_, sampler, shares.cosine_rays, shares.sky_rays, own_seed, sum);
        return sum.rgb();
    }

    void push(TexelRays& batch, const SurfacePoint& at, const Vec3f& direction, float cosine, std::uint32_t number) const {
        batch.number[batch.count] = number;
        batch.rays[batch.count] = {offset_origin(at.position, at.normal, in_.scene.corner_extent(at.triangle)), direction,
                                   at.triangle};
        batch.cosine[batch.count++] = cosine;
    }

    void trace(TexelRays& batch) const {
        in_.tracer.first_hits({batch.rays.data(), batch.count}, {batch.hits.data(), batch.count});
    }

    void cast_cosine(const SurfaceSampler& sampler, const SobolSequence& sequence, std::uint32_t begin, std::uint32_t end,
                     TexelRays& batch) const {
        std::array<std::array<float, batch_rays>, 4> u;
        sequence.points(begin, u);
        batch.count = 0;
        for (std::uint32_t k = 0; k < end - begin; ++k) {
            const SurfacePoint at = sampler.point(u[0][k], u[1][k]);
            const Vec3f local = cosine_direction(u[2][k], u[3][k]);
            const Vec3f direction = Frame(sampler.shading_normal(at)).to_world(local);
            // Below the true surface there is only the inside of the object.
            if (direction.dot(at.normal) > 0) push(batch, at, direction, local.z, begin + k);
        }
        trace(batch);
    }

    void cast_aimed(const SurfaceSampler& sampler, const SobolSequence& sequence, const SobolSequence& aims,
                    const Plan& shares, std::uint32_t begin, std::uint32_t end, TexelRays& batch) const {
        batch.count = 0;
        for (std::uint32_t k = begin; k < end; ++k) {
            // The points of the texel go on where those of the cosine rays end.
            const auto u = sequence.point(shares.cosine_rays + k);
            const auto w = aims.point(k);
            const SurfacePoint at = sampler.point(u[0], u[1]);
            const EmitterSet::Aim target = in_.emitters.aim(shares.probability, w[0], w[1], w[2]);
            const Vec3f to = target.point.position - at.position;
            const float distance = to.length();
            if (!(distance > 0)) continue;
            const Vec3f direction = to / distance;
            const float cosine = direction.dot(sampler.shading_normal(at));
            if (cosine <= 0 || direction.dot(at.normal) <= 0 || direction.dot(target.point.normal) >= 0) continue;
            batch.target[batch.count] = target;
            push(batch, at, direction, cosine, shares.cosine_rays + k);
        }
        trace(batch);
    }

    void add_cosine(const TexelRays& batch, std::size_t k, const Plan& shares, const NearLight& near,
                    std::vector<NearVertex>& vertices, LightSum& sum) const {
        const Landing at = landing(in_.scene, in_.atlas, in_.patches, batch.hits[k]);
        if (at.end == RayEnd::open)
            sum.add(open_ray_light(in_.sky, batch.rays[k].direction, batch.cosine[k], shares.cosine_rays, shares.sky_rays), batch.hits[k].tint);
        if (at.end != RayEnd::patch) return;
        const Rgb& emission = in_.patches.patches[at.patch].emission;
        const float share = 1.0f / static_cast<float>(shares.cosine_rays);
        if (near.is_near(batch.hits[k].distance_m))
            vertices.push_back(near.vertex(batch.rays[k], batch.hits[k], at.patch, batch.number[k], batch.hits[k].tint * share));
        else
            sum.add(in_.reflected[at.patch], batch.hits[k].tint * share);
        if (emission != Rgb(0, 0, 0)) sum.add(emission, batch.hits[k].tint * weight(batch, k, at.patch, shares));
    }

    void add_aimed(const TexelRays& batch, std::size_t k, const Plan& shares, LightSum& sum) const {
        const Landing at = landing(in_.scene, in_.atlas, in_.patches, batch.hits[k]);
        // Both kinds of rays mean the same by "sees patch j": the first hit is on it.
        if (at.end != RayEnd::patch || at.patch != batch.target[k].patch) return;
        sum.add(in_.patches.patches[at.patch].emission, batch.hits[k].tint * weight(batch, k, at.patch, shares));
    }

    /// Balance heuristic: cosine / pi over the sum of both densities of this direction, times the numbers of rays.
    [[nodiscard]] float weight(const TexelRays& batch, std::size_t k, PatchNumber patch, const Plan& shares) const {
        const float by_cosine = batch.cosine[k] * static_cast<float>(1 / pi);
        const float aimed = shares.aimed_rays ? in_.emitters.density_per_sr(shares.probability, patch, in_.scene, batch.rays[k], batch.hits[k]) : 0.0f;
        return by_cosine /
               (static_cast<float>(shares.cosine_rays) * by_cosine + static_cast<float>(shares.aimed_rays) * aimed);
    }

    [[nodiscard]] Rgb direct(const SurfaceSampler& sampler, const SobolSequence& sequence, std::uint64_t own_seed) const {
        Rgb sum(0, 0, 0);
        if (lamps_.empty()) return sum;
        const SobolSequence on_lamps(mix(own_seed, 0x6f6e6c616d70));
        for (std::uint32_t k = 0; k < options_.lamp_points; ++k) {
            const auto u = sequence.point(k);
            const SurfacePoint at = sampler.point(u[0], u[1]);
            const auto on_lamp = on_lamps.point(k);
            sum += lamps_.irradiance({at.position, at.normal, sampler.shading_normal(at), at.triangle}, u[2], {on_lamp[0], on_lamp[1]});
        }
        return sum / static_cast<float>(options_.lamp_points);
    }

    const GatherInput& in_;
    const PageTexels& page_;
    const GatherOptions& options_;
    LampLight lamps_;
};

}  // namespace

std::vector<Rgb> gather_page(const GatherInput& input, std::uint32_t page, const GatherOptions& options,
                             ProgressCounter* progress) {
    const TexelGather gather(input, page, options);
    std::vector<Rgb> irradiance(input.texels.pages[page].texels.size());
    std::atomic<bool> stopped{false};
    parallel_ranges(irradiance.size(), 256, [&](std::size_t, std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            if (options.stop && options.stop->is_asked()) stopped = true;
            if (stopped) return;
            irradiance[k] = gather.irradiance(k);
        }
        if (progress) progress->add(end - begin);
    });
    if (stopped) irradiance.clear();
    return irradiance;
}

}  // namespace luxel
