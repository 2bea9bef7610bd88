#include "baker/light/sky_gather.h"

#include <cmath>

#include "baker/core/sobol.h"
#include "baker/core/units.h"
#include "baker/core/ray_offset.h"
#include "baker/trace/smooth_start.h"

namespace luxel {
namespace {

constexpr std::uint64_t place_purpose = 0x736b79706c, aim_purpose = 0x736b796169;

/// Radiance times cosine over what both kinds of rays together look into this direction.
Rgb balanced(const Sky& sky, const Vec3f& direction, float cosine, float cosine_rays, std::uint32_t aimed_rays, float density) {
    const float rays = cosine_rays * cosine * static_cast<float>(1 / pi) + static_cast<float>(aimed_rays) * density;
    return sky.radiance(direction) * (cosine / std::max(rays, 1e-30f));
}

}  // namespace

std::uint32_t aimed_sky_rays(const Sky* sky, std::uint32_t rays) {
    return sky && sky->is_uneven() && !sky->is_dark() ? std::max(1u, rays / 2) : 0;
}

Rgb open_ray_light(const Sky* sky, const Vec3f& direction, float cosine, float cosine_rays, std::uint32_t aimed_rays) {
    if (!sky || !(cosine > 0)) return {0, 0, 0};
    return balanced(*sky, direction, cosine, cosine_rays, aimed_rays, aimed_rays ? sky->density(direction) : 0.0f);
}

void add_aimed_sky(const GatherInput& input, const SurfaceSampler& sampler, const GuideWarp& warp, const Frame& frame,
                   std::uint32_t cosine_rays, std::uint32_t aimed_rays, std::uint64_t seed, LightSum& sum) {
    const SobolSequence places(mix(seed, place_purpose));
    const ShuffledSobol aims(mix(seed, aim_purpose));
    for (std::uint32_t k = 0; k < aimed_rays; ++k) {
        const auto u = places.point(k), w = aims.point(k);
        const SurfacePoint at = sampler.point(u[0], u[1]);
        const Sky::Sample aim = input.sky->sample(w[0], w[1]);
        const Vec3f local = guide_frame(frame, sampler.shading_normal(at)).to_local(aim.direction);
        const float cosine = local.z;
        if (cosine <= 0) continue;
        const std::optional<TraceRay> ray = leave_towards(input.scene, input.tracer, at, aim.direction);
        if (!ray) continue;
        sum.add(balanced(*input.sky, aim.direction, cosine, static_cast<float>(cosine_rays) * warp.density(local), aimed_rays, aim.density),
                input.tracer.transmittance(*ray, INFINITY));
    }
}

void add_aimed_sky(const GatherInput& input, std::span<const NearVertex> vertices, std::uint64_t seed, LightSum& sum) {
    if (!aimed_sky_rays(input.sky, 1)) return;
    const ShuffledSobol aims(mix(seed, aim_purpose));
    for (const NearVertex& at : vertices) {
        const auto w = aims.point(at.ray);
        const Sky::Sample aim = input.sky->sample(w[0], w[1]);
        const float cosine = aim.direction.dot(at.normal);
        if (cosine <= 0) continue;
        const TraceRay ray{offset_origin(at.position, at.normal, input.scene.corner_extent(at.triangle)), aim.direction, at.triangle};
        sum.add(balanced(*input.sky, aim.direction, cosine, 1, 1, aim.density),
                at.throughput * input.tracer.transmittance(ray, INFINITY));
    }
}

}  // namespace luxel
