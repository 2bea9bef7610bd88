/// From a hit to the patch that received the ray: the one rule of sides, shared by evidence and final gathering.
#pragma once
#include "baker/patches/patch_lookup.h"
#include "baker/trace/tracer.h"

namespace luxel {

/// Where a ray ended.
enum class RayEnd { patch, open, back };

struct Landing {
    RayEnd end = RayEnd::open;
    PatchNumber patch = no_patch;  ///< for RayEnd::patch
};

/// A front belongs to its texel's patch; a back to that patch's other side where there is one; any other back absorbs.
/// `at`: the hit's texel, unless nothing was hit.
inline Landing landing(const PatchSet& patches, const TraceHit& hit, const SurfaceTexel& at) {
    if (hit.triangle == none) return {RayEnd::open, no_patch};
    PatchNumber patch = front_patch_at(patches, at);
    if (patch != no_patch && !hit.front) patch = patches.patches[patch].other_side;
    if (patch == no_patch) return {RayEnd::back, no_patch};
    return {RayEnd::patch, patch};
}

inline Landing landing(const Scene&, const Atlas& atlas, const PatchSet& patches, const TraceHit& hit) {
    if (hit.triangle == none) return {RayEnd::open, no_patch};
    return landing(patches, hit, surface_texel(atlas, patches, hit.triangle, hit.b1, hit.b2));
}

}  // namespace luxel
