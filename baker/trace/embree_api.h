/// The one place that knows whether Embree 3 or 4 is there. Included by tracer.cpp, and by the benchmark
/// that measures what tracer.cpp costs.
#pragma once
#if LUXEL_EMBREE_MAJOR >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

namespace luxel {

inline void embree_intersect8(const int* valid, RTCScene scene, RTCRayHit8& rays) {
#if LUXEL_EMBREE_MAJOR >= 4
    rtcIntersect8(valid, scene, &rays);
#else
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
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
