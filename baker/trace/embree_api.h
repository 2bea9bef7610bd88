/// The one place that knows whether Embree 3 or 4 is there. Included by tracer.cpp, and by the benchmark
/// that measures what tracer.cpp costs.
#pragma once
#if LUXEL_EMBREE_MAJOR >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

namespace luxel {

/// What a query hands to the filters that it calls.
#if LUXEL_EMBREE_MAJOR >= 4
struct EmbreeContext : RTCRayQueryContext {
    EmbreeContext() { rtcInitRayQueryContext(this); }
};
#else
struct EmbreeContext : RTCIntersectContext {
    EmbreeContext() { rtcInitIntersectContext(this); }
};
#endif

/// `coherent`: the rays walk the tree together for as long as they can.
inline void embree_intersect8(const int* valid, RTCScene scene, RTCRayHit8& rays, bool coherent, EmbreeContext& context) {
#if LUXEL_EMBREE_MAJOR >= 4
    RTCIntersectArguments arguments;
    rtcInitIntersectArguments(&arguments);
    if (coherent) arguments.flags = RTC_RAY_QUERY_FLAG_COHERENT;
    arguments.context = &context;
    rtcIntersect8(valid, scene, &rays, &arguments);
#else
    if (coherent) context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    rtcIntersect8(valid, scene, &context, &rays);
#endif
}

inline void embree_intersect8(const int* valid, RTCScene scene, RTCRayHit8& rays, bool coherent = false) {
    EmbreeContext context;
    embree_intersect8(valid, scene, rays, coherent, context);
}

inline void embree_intersect1(RTCScene scene, RTCRayHit& ray, EmbreeContext& context) {
#if LUXEL_EMBREE_MAJOR >= 4
    RTCIntersectArguments arguments;
    rtcInitIntersectArguments(&arguments);
    arguments.context = &context;
    rtcIntersect1(scene, &ray, &arguments);
#else
    rtcIntersect1(scene, &context, &ray);
#endif
}

inline void embree_intersect1(RTCScene scene, RTCRayHit& ray) {
    EmbreeContext context;
    embree_intersect1(scene, ray, context);
}

inline void embree_occluded1(RTCScene scene, RTCRay& ray, EmbreeContext& context) {
#if LUXEL_EMBREE_MAJOR >= 4
    RTCOccludedArguments arguments;
    rtcInitOccludedArguments(&arguments);
    arguments.context = &context;
    rtcOccluded1(scene, &ray, &arguments);
#else
    rtcOccluded1(scene, &context, &ray);
#endif
}

inline void embree_occluded1(RTCScene scene, RTCRay& ray) {
    EmbreeContext context;
    embree_occluded1(scene, ray, context);
}

}  // namespace luxel
