#include "baker/light/gather.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "baker/core/parallel.h"
#include "baker/core/sampling.h"
#include "baker/core/sobol.h"
#include "baker/core/units.h"
#include "baker/trace/surface_map.h"
#include "baker/light/light_sum.h"
#include "baker/light/near_light.h"
#include "baker/light/sky_gather.h"
#include "baker/light/texel_lamps.h"
#include "baker/light/texel_seed.h"
#include "baker/patches/patch_sampler.h"
#include "baker/trace/smooth_start.h"

namespace luxel {
namespace {

constexpr std::size_t batch_rays = SobolSequence::batch;

/// One batch of rays of a texel. Only the first `count` entries are rays; others were below the surface.
struct TexelRays {
    std::array<TraceRay, batch_rays> rays;
    std::array<TraceHit, batch_rays> hits;
    std::array<SurfaceTexel, batch_rays> ends;       ///< where cosine rays have hit something
    std::array<float, batch_rays> cosine;            ///< against the shading normal
    std::array<float, batch_rays> density;           ///< of cosine rays in its direction, relative to the plain distribution
    std::array<std::uint32_t, batch_rays> number;    ///< of the texel's rays
    std::array<EmitterSet::Aim, batch_rays> target;  ///< of aimed rays
    std::size_t count = 0;
};

class TexelGather {
  public:
    TexelGather(const GatherInput& input, std::uint32_t page, const GatherOptions& options)
        : in_(input), number_(page), page_(input.texels.pages[page]), options_(options) {}

    void light(std::size_t index, GatheredPage& result) const {
        const Texel& texel = page_.texels[index];
        if (!may_have_light(texel)) return;
        gather(index, sampler_of(texel), options_.rays, seed(texel), 1, result);
    }

    /// As many rays as the texel has had, after `doublings` times.
    void double_rays(std::size_t index, std::uint32_t doublings, GatheredPage& result) const {
        const Texel& texel = page_.texels[index];
        if (!may_have_light(texel)) return;
        gather(index, sampler_of(texel), options_.rays << doublings, mix(seed(texel), 0x6d6f7265 + doublings), 0.5f, result);
    }

  private:
    [[nodiscard]] PatchNumber patch_of(const Texel& texel) const {
        return in_.patches.page_patch[number_][std::size_t{texel.y} * in_.patches.page_size + texel.x];
    }
    [[nodiscard]] bool may_have_light(const Texel& texel) const {
        if (!page_.can_send(texel)) return false;
        const PatchNumber patch = in_.dark.empty() ? no_patch : patch_of(texel);
        return patch == no_patch || !in_.dark[patch];
    }
    [[nodiscard]] SurfaceSampler sampler_of(const Texel& texel) const {
        return {in_.scene, in_.atlas, {page_.fragments.data() + texel.first_fragment, texel.fragment_count}, false};
    }
    [[nodiscard]] std::uint64_t seed(const Texel& texel) const { return texel_seed(in_.scene, in_.atlas, texel, options_.seed); }

    /// Adds what both halves of `rays` find; it gets the share `share` of the mean, what was there before the rest.
    void gather(std::size_t index, const SurfaceSampler& sampler, std::uint32_t rays, std::uint64_t own_seed, float share,
                GatheredPage& result) const {
        const Plan shares = plan(page_.texels[index], sampler, rays);
        NearLight near(in_, options_.near_m, shares.middle, shares.aimed_rays > 0);
        std::array<HalfLight, 2> found;
        for (std::size_t half = 0; half < 2; ++half) found[half] = indirect(sampler, shares, near, mix(own_seed, half));
        const auto put = [&](Rgb& mean, const Rgb& light) { mean = share < 1 ? mean * (1 - share) + light * share : light; };
        for (std::size_t half = 0; half < 2; ++half) {
            const HalfLight &own = found[half], &other = found[1 - half];
            // Rays that are aimed besides share the weight of what emits with the cosine rays.
            const bool is_shared = shares.aimed_rays || shares.sky_rays;
            put(result.emitted.halves[half][index], is_shared ? own.emitted : controlled(own, other, &HalfLight::emitted));
            put(result.reflected.halves[half][index], controlled(own, other, &HalfLight::reflected));
        }
        result.rays[index] += found[0].rays + found[1].rays;
    }

    /// How half of the rays of a texel are shared out, and where light is likely.
    struct Plan {
        std::uint32_t cosine_rays = 0, aimed_rays = 0, sky_rays = 0;
        std::vector<float> emitters_up_to;  ///< EmitterSet::weigh
        GuideWarp warp;
        Frame frame{Vec3f(0, 0, 1)};  ///< of the patch: what the warp refers to
        std::optional<Frame> even;    ///< guide_frame at every point of the texel, if it is the same
        Vec3f middle;
        [[nodiscard]] Frame frame_at(const SurfaceSampler& sampler, const SurfacePoint& at) const {
            return even ? *even : guide_frame(frame, sampler.shading_normal(at));
        }
    };
    struct HalfLight {
        Rgb emitted, reflected;
        float weights = 0;  ///< of the cosine rays, all of them; 1 on average
        std::uint32_t rays = 0;
    };

    /// Control variate: light that is the same from everywhere is known without noise, since the weights should sum to 1. How much
    /// that is, the other half says, which knows nothing of this one's noise.
    static Rgb controlled(const HalfLight& half, const HalfLight& other, Rgb HalfLight::*light) {
        return other.weights > 0 ? half.*light + other.*light * ((1 - half.weights) / other.weights) : half.*light;
    }

    [[nodiscard]] Plan plan(const Texel& texel, const SurfaceSampler& sampler, std::uint32_t rays) const {
        Plan plan;
        plan.cosine_rays = rays / 2;
        plan.sky_rays = aimed_sky_rays(in_.sky, plan.cosine_rays);
        const SurfacePoint middle = sampler.point(0.5f, 0.5f);
        plan.middle = middle.position;
        const PatchNumber patch = patch_of(texel);
        if (patch != no_patch && !in_.guides.empty()) {
            plan.warp = GuideWarp(in_.guides.of(patch));
            plan.frame = Frame(in_.patches.patches[patch].normal);
        }
        const Vec3f normal = sampler.shading_normal(middle);
        if (sampler.one_shading_normal()) plan.even = guide_frame(plan.frame, normal);
        if (!options_.aim_at_emitters || in_.emitters.empty()) return plan;
        const float seen = in_.emitters.weigh(middle.position, normal, plan.emitters_up_to);
        // Cosine rays find large emitters by themselves, with less noise than points on them.
        if (!plan.emitters_up_to.empty() && seen < 0.5f) plan.aimed_rays = rays / (seen < 0.25f ? 4 : 8);
        // Where hardly any light comes straight from them, they are out of sight.
        if (patch != no_patch && !in_.guides.empty() && in_.guides.emitted_share(patch) < 0.05f)
            plan.aimed_rays = std::min(plan.aimed_rays, rays / 16);
        plan.cosine_rays -= plan.aimed_rays;
        return plan;
    }

    [[nodiscard]] HalfLight indirect(const SurfaceSampler& sampler, const Plan& shares, NearLight& near, std::uint64_t own_seed) const {
        const SobolSequence sequence(own_seed);
        const ShuffledSobol aims(mix(own_seed, 0x61696d));
        near.start(own_seed);
        std::vector<NearVertex> vertices;
        LightSum emitted, reflected;
        double weights = 0;
        TexelRays batch;
        for (std::uint32_t begin = 0; begin < shares.cosine_rays; begin += batch_rays) {
            weights += cast_cosine(sampler, sequence, shares, begin, std::min<std::uint32_t>(shares.cosine_rays, begin + batch_rays), batch);
            for (std::size_t k = 0; k < batch.count; ++k) add_cosine(batch, k, shares, near, vertices, emitted, reflected);
            if (!vertices.empty()) near.add(vertices, reflected);
        }
        for (std::uint32_t begin = 0; begin < shares.aimed_rays; begin += batch_rays) {
            cast_aimed(sampler, sequence, aims, shares, begin,
                       std::min<std::uint32_t>(shares.aimed_rays, begin + batch_rays), batch);
            for (std::size_t k = 0; k < batch.count; ++k) add_aimed(batch, k, shares, emitted);
        }
        if (shares.sky_rays) add_aimed_sky(in_, sampler, shares.warp, shares.frame, shares.cosine_rays, shares.sky_rays, own_seed, emitted);
        return {emitted.rgb(), reflected.rgb(), static_cast<float>(weights / shares.cosine_rays),
                shares.cosine_rays + shares.aimed_rays + shares.sky_rays + near.ray_count()};
    }

    void push(TexelRays& batch, const TraceRay& ray, float cosine, float density, std::uint32_t number) const {
        batch.number[batch.count] = number;
        batch.density[batch.count] = density;
        batch.rays[batch.count] = ray;
        batch.cosine[batch.count++] = cosine;
    }

    void trace(TexelRays& batch) const {
        in_.tracer.first_hits({batch.rays.data(), batch.count}, {batch.hits.data(), batch.count});
    }

    /// Returns the sum of 1 / density over all of them, also those that end at once below the surface.
    double cast_cosine(const SurfaceSampler& sampler, const SobolSequence& sequence, const Plan& shares, std::uint32_t begin,
                     std::uint32_t end, TexelRays& batch) const {
        std::array<std::array<float, batch_rays>, 4> u;
        std::array<float, batch_rays> density, x, y, z;
        sequence.points(begin, u);
        const std::size_t count = end - begin;
        double weights = 0;
        for (std::size_t k = 0; k < count; ++k) {
            const GuideWarp::Point bent = shares.warp.bend(u[2][k], u[3][k]);
            weights += 1 / static_cast<double>(bent.density);
            u[2][k] = bent.u, u[3][k] = bent.v, density[k] = bent.density;
        }
        cosine_directions({u[2].data(), count}, {u[3].data(), count}, x.data(), y.data(), z.data());
        batch.count = 0;
        for (std::uint32_t k = 0; k < count; ++k) {
            const SurfacePoint at = sampler.point(u[0][k], u[1][k]);
            const Vec3f direction = shares.frame_at(sampler, at).to_world({x[k], y[k], z[k]});
            // Below the true surface there is only the inside of the object.
            if (const auto ray = leave_towards(in_.scene, in_.tracer, at, direction)) push(batch, *ray, z[k], density[k], begin + k);
        }
        trace(batch);
        // All places in memory are asked for before the first is needed.
        for (std::size_t k = 0; k < batch.count; ++k) {
            const TraceHit& hit = batch.hits[k];
            if (hit.triangle == none) continue;
            batch.ends[k] = surface_texel(in_.atlas, in_.patches, hit.triangle, hit.b1, hit.b2);
            __builtin_prefetch(batch.ends[k].patch);
            in_.radiosity.prefetch(in_.patches, batch.ends[k]);
        }
        return weights;
    }

    void cast_aimed(const SurfaceSampler& sampler, const SobolSequence& sequence, const ShuffledSobol& aims,
                    const Plan& shares, std::uint32_t begin, std::uint32_t end, TexelRays& batch) const {
        batch.count = 0;
        for (std::uint32_t k = begin; k < end; ++k) {
            // The points of the texel go on where those of the cosine rays end.
            const auto u = sequence.point(shares.cosine_rays + k);
            const auto w = aims.point(k);
            const SurfacePoint at = sampler.point(u[0], u[1]);
            const EmitterSet::Aim target = in_.emitters.aim(shares.emitters_up_to, w[0], w[1], w[2]);
            const Vec3f to = target.point.position - at.position;
            const float distance = to.length();
            if (!(distance > 0)) continue;
            const Vec3f direction = to / distance;
            const Vec3f local = shares.frame_at(sampler, at).to_local(direction);
            if (local.z <= 0 || direction.dot(target.point.normal) >= 0) continue;
            auto ray = leave_towards(in_.scene, in_.tracer, at, direction);
            if (!ray) continue;
            if (ray->from_triangle == none) ray->direction = (target.point.position - ray->origin).normalized();
            batch.target[batch.count] = target;
            push(batch, *ray, local.z, shares.warp.density(local), shares.cosine_rays + k);
        }
        trace(batch);
    }

    void add_cosine(const TexelRays& batch, std::size_t k, const Plan& shares, const NearLight& near,
                    std::vector<NearVertex>& vertices, LightSum& emitted, LightSum& reflected) const {
        const TraceHit& hit = batch.hits[k];
        const float density = static_cast<float>(shares.cosine_rays) * batch.density[k];
        if (hit.triangle == none) {
            emitted.add(open_ray_light(in_.sky, batch.rays[k].direction, batch.cosine[k], density, shares.sky_rays), hit.tint);
            return;
        }
        const SurfaceTexel& texel = batch.ends[k];
        const Landing at = landing(in_.patches, hit, texel);
        if (at.end != RayEnd::patch) return;
        const Rgb& emission = in_.patches.patches[at.patch].emission;
        if (near.follows(hit, texel))
            vertices.push_back(near.vertex(batch.rays[k], hit, at.patch, batch.number[k], hit.tint / density));
        else
            reflected.add(in_.radiosity.at(at.patch, in_.patches, texel), hit.tint / density);
        if (emission != Rgb(0, 0, 0)) emitted.add(emission, hit.tint * weight(batch, k, at.patch, shares));
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
        const float aimed = shares.aimed_rays ? in_.emitters.density_per_sr(shares.emitters_up_to, patch, in_.scene, batch.rays[k], batch.hits[k]) : 0.0f;
        return by_cosine / (static_cast<float>(shares.cosine_rays) * by_cosine * batch.density[k] +
                            static_cast<float>(shares.aimed_rays) * aimed);
    }

    const GatherInput& in_;
    std::uint32_t number_;  ///< of the page
    const PageTexels& page_;
    const GatherOptions& options_;
};

/// False if it was asked to stop.
template <class Visit>
bool for_texels(std::size_t count, const GatherOptions& options, ProgressCounter* progress, const Visit& visit) {
    std::atomic<bool> stopped{false};
    parallel_ranges(count, 256, [&](std::size_t, std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            if (options.stop && options.stop->is_asked()) stopped = true;
            if (stopped) return;
            visit(k);
        }
        if (progress) progress->add(end - begin);
    });
    return !stopped;
}

}  // namespace

std::vector<Rgb> GatheredPage::irradiance() const {
    std::vector<Rgb> sum(lamps.size());
    for (std::size_t k = 0; k < sum.size(); ++k) sum[k] = lamps[k] + gathered(k);
    return sum;
}

std::optional<GatheredPage> gather_page(const GatherInput& input, std::uint32_t page, const GatherOptions& options,
                                        ProgressCounter* progress) {
    const TexelGather gather(input, page, options);
    const std::size_t count = input.texels.pages[page].texels.size();
    GatheredPage result;
    result.rays.assign(count, 0);
    for (GatheredLight* light : {&result.emitted, &result.reflected})
        for (std::vector<Rgb>& half : light->halves) half.assign(count, Rgb(0, 0, 0));
    const bool done = for_texels(count, options, progress, [&](std::size_t k) { gather.light(k, result); });
    if (!done) return {};
    std::vector<float> gathered(count);
    for (std::size_t k = 0; k < count; ++k) gathered[k] = luminance(result.gathered(k));
    const TexelLampOptions lamp_options{options.lamp_points, options.edge_lamp_points, options.seed, options.stop};
    auto lamps = texel_lamps(input.scene, input.atlas, input.texels.pages[page], input.texels.page_size, input.tracer,
                             gathered, lamp_options);
    if (!lamps) return {};
    result.lamps = std::move(*lamps);
    return result;
}

bool double_rays(const GatherInput& input, std::uint32_t page, const GatherOptions& options, std::span<const std::uint32_t> chosen,
                 std::span<std::uint8_t> doublings, GatheredPage& light) {
    const TexelGather gather(input, page, options);
    return for_texels(chosen.size(), options, nullptr, [&](std::size_t k) { gather.double_rays(chosen[k], doublings[chosen[k]]++, light); });
}

}  // namespace luxel
