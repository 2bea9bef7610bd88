/// Scene -> Atlas: every triangle gets a place on a lightmap page, at one density for the whole scene but for objects that have one of
/// their own. Objects without a lightmap get theirs on pages of their own, behind the others: they are for the computation only.
///
/// Time grows linearly with triangles: objects are cut into pieces of bounded size, identical meshes are unwrapped once.
/// A chart depends on its own object's mesh and size (where copies of several sizes share a layout: on the largest of them), the
/// density and the page size only: never on other objects, on where the object stands or the chart is packed, or on the
/// number of threads.
/// What xatlas cannot unwrap gets planar charts and a warning; nothing is lost.
#pragma once
#include <cstdint>
#include <vector>

#include "baker/core/progress.h"
#include "baker/scene/scene.h"
#include "baker/unwrap/atlas.h"
#include "formats/base/error.h"

namespace luxel {

enum class UvMode {
    unwrap,  ///< new charts for everything
    keep     ///< an object's TEXCOORD_1 is used where it is fit for it, as one block with its relative places
};

enum class InstanceMode {
    share,  ///< copies of a mesh share one layout (mesh_copies.h), each in a block of its own
    split   ///< every instance is packed chart by chart
};

struct UnwrapOptions {
    double texels_per_metre = 0;  ///< > 0; 0: chosen so that what has a lightmap fills about half a page, in steps of 2^(1/4)
    std::uint32_t page_size = 1024;  ///< texels, 16 .. 16384
    std::uint32_t padding = 2;       ///< free texels between charts, 0 .. page_size / 8
    UvMode uv_mode = UvMode::unwrap;
    InstanceMode instances = InstanceMode::share;
    std::uint32_t piece_triangles = 1024;  ///< most triangles given to xatlas at once: its time grows with their square
    bool each_copy = false;  ///< unwrap objects of the same shape one by one: the same charts, later
    double piece_time_limit_s = 120;       ///< last resort against a piece that never ends; it is warned about
};

/// Texels per metre for surfaces of `area_m2` on pages of `page_size`: half a page, rounded down to a power of 2^(1/4).
double automatic_density(double area_m2, std::uint32_t page_size);

/// Warnings: "unwrap-fallback" (an object with triangles in planar charts), "unwrap-slow" (a piece met the time limit),
/// "chart-scaled" (fewer texels per metre than asked for), "uv-not-kept" (why TEXCOORD_1 was replaced), "copies-without-block" (place_charts.h).
/// Progress in triangles. Errors: Error{usage} for options out of range. An empty scene gives an empty atlas.
Atlas unwrap(const Scene& scene, const UnwrapOptions& options, std::vector<Warning>& warnings,
             const ProgressFunction& progress);

/// Objects whose shape and density another one before them has: they get its charts.
std::size_t repeated_objects(const Scene& scene);

/// Pages that hold lightmaps: the first ones.
std::uint32_t shown_page_count(const Scene& scene, const Atlas& atlas);

}  // namespace luxel
