/// Where rays leave a surface whose shading normals say that it is round (patches/smooth_rise.h).
///
/// Only rays that graze or go below the flat triangle start on the smooth surface: a convex mesh is in nobody's way
/// otherwise, and near objects keep their shadows. The move fades out up to a sine of 0.1 above the triangle, as in Blender's
/// Cycles (shadow terminator, geometry offset). It is made only where the way to the moved start is free, which one short ray
/// tests: what is nearer than the move is never passed. Where it is not free, as where nothing is to be moved, a ray starts on
/// the triangle, and below that there is only the inside of the object.
///
/// Limits: what stands beside the way to the moved start and is lower than the move is passed by rays that graze.
/// Threads: pure functions. Errors: none.
#pragma once
#include <optional>

#include "baker/patches/patch_sampler.h"
#include "baker/trace/tracer.h"

namespace luxel {

/// A point that rays leave.
struct RayStart {
    Vec3f position;  ///< on the triangle
    Vec3f normal;    ///< unit geometric normal of the side that rays leave to
    std::uint32_t triangle = none;
    Vec3f rise{0, 0, 0};  ///< smooth_rise() of the point, m; 0: none
};

/// The ray to the unit `direction`. Nothing if only the inside of the object lies there. Of a ray that starts above the triangle
/// from_triangle is `none`: it may meet that triangle too.
std::optional<TraceRay> leave_towards(const Scene& scene, const Tracer& tracer, const RayStart& from, const Vec3f& direction);
/// The same of a sampled point; finds its rise only for rays that need it.
std::optional<TraceRay> leave_towards(const Scene& scene, const Tracer& tracer, const SurfacePoint& from, const Vec3f& direction);

}  // namespace luxel
