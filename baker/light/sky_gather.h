/// Light of the sky in final gathering. Cosine rays that leave the scene see it by themselves; where it is uneven further
/// rays are aimed at what is bright in it. The two are combined by the balance heuristic, as in gather.h, so the mean depends
/// on neither.
#pragma once
#include <span>

#include "baker/light/gather.h"
#include "baker/light/light_sum.h"
#include "baker/light/near_light.h"
#include "baker/light/sky.h"
#include "baker/patches/patch_sampler.h"

namespace luxel {

/// Rays that are aimed at the sky beside `rays` others; 0: no sky, or an even one.
std::uint32_t aimed_sky_rays(const Sky* sky, std::uint32_t rays);

/// What a cosine ray brings that left the scene at `cosine` to the normal: irradiance, lux. `cosine_rays`: how many there are, times
/// their density in this direction relative to the plain distribution. No sky: nothing.
Rgb open_ray_light(const Sky* sky, const Vec3f& direction, float cosine, float cosine_rays, std::uint32_t aimed_rays);

/// The aimed rays of a texel, beside cosine rays that `warp` bends in `frame`; `seed`: its own.
void add_aimed_sky(const GatherInput& input, const SurfaceSampler& sampler, const GuideWarp& warp, const Frame& frame,
                   std::uint32_t cosine_rays, std::uint32_t aimed_rays, std::uint64_t seed, LightSum& sum);

/// One aimed ray from each vertex of a path, beside its one cosine ray; `seed`: of texel and depth.
void add_aimed_sky(const GatherInput& input, std::span<const NearVertex> vertices, std::uint64_t seed, LightSum& sum);

}  // namespace luxel
