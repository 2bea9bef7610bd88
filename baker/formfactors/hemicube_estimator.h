/// Form factors by the hemicube of the lecture: the patch's surroundings are projected onto the pixels of a half cube around
/// one point of it, and each pixel's delta form factor goes to the patch seen there (hemicube_weights.h).
///
/// One replicate, one level range: 0 .. hemicube_level, so that weights in fixed point read as that many rays. Any other
/// range is Error{internal}. More accuracy is another resolution and another store; never pooled with rays: what it finds is
/// the form factor of a point, with the alias of its pixels, and repeats itself instead of scattering. A standard error
/// from its counts has no meaning.
///
/// The point: the centre of gravity of the patch's visible area where the patch's surface passes under it, else the nearest
/// middle of a visible piece of the patch. The cube is turned about the normal by an angle drawn from patch id and seed: fixed for the patch
/// for ever, different for neighbours, so that aliases of a row of patches do not add up to a pattern.
///
/// Surfaces that let light through are met by chance, as by rays (ray_estimator.h); of a pixel's weight behind tinted panes the mean of
/// the channels is left, the rest counts as absorbed.
///
/// The item buffer is filled by a ray through the centre of each pixel rather than by a raster: its rules of sides, of
/// coincident triangles and of rays at their own surface are then those of all other light, its cost grows with the logarithm
/// of the number of triangles (a raster draws every triangle for every patch), and a patch is found by texel, not by polygon.
#pragma once
#include "baker/formfactors/estimator.h"
#include "baker/trace/tracer.h"
#include "baker/unwrap/atlas.h"

namespace luxel {

struct HemicubeOptions {
    std::uint64_t seed = 0;
    std::uint32_t resolution = 64;  ///< pixels along an edge of the top: even, 2 .. 4096; 3 * resolution^2 rays per patch
};

/// References must outlive the estimator. Throws Error{usage} for a resolution out of range.
std::unique_ptr<Estimator> make_hemicube_estimator(const Scene& scene, const Atlas& atlas, const PatchSet& patches,
                                                   const Tracer& tracer, const HemicubeOptions& options);

/// Where the hemicube of a patch stands: on its surface, with the unit geometric normal there, on the side of the patch.
struct HemicubePlace {
    Vec3f position{0, 0, 0}, normal{0, 0, 1};
    std::uint32_t triangle = none;
};
HemicubePlace hemicube_place(const Scene& scene, const Atlas& atlas, const PatchSet& patches, PatchNumber patch);

}  // namespace luxel
