/// The one place that knows whether Embree 3 or 4 is there. Included by tracer.cpp, and by the benchmark
/// that measures what tracer.cpp costs.
#pragma once
#if LUXEL_EMBREE_MAJOR >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

namespace luxel {

/// `coherent`: the rays walk the tree together for as long as they can.
inline void embree_intersect8(const int* valid, RTCScene scene, RTCRayHit8& rays, bool coherent = false) {
#if LUXEL_EMBREE_MAJOR >= 4
    RTCIntersectArguments arguments;
    rtcInitIntersectArguments(&arguments);
    if (coherent) arguments.flags = RTC_RAY_QUERY_FLAG_COHERENT;
    rtcIntersect8(valid, scene, &rays, &arguments);
#else
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    if (coherent) context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    rtcIntersect8(valid, scene, &context, &rays);
#endif
}

inline void embree_intersect1(RTCScene scene, RTCRayHit& ray) {
#if LUXEL_EMBREE_MAJOR >= 4
    rtcIntersect1(scene, &ray);
#else
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(scene, &context, &ray);
#endif
}

inline void embree_occluded1(RTCScene scene, RTCRay& ray) {
#if LUXEL_EMBREE_MAJOR >= 4
    rtcOccluded1(scene, &ray);
#else
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1(scene, &context, &ray);
#endif
}

}  // namespace luxel
