/// From a point on the surface to its patch: on the way of every ray, so inline and cheap.
/// Threads: pure functions. Errors: none.
#pragma once
#include <algorithm>

#include "baker/patches/patch.h"
#include "baker/scene/scene.h"
#include "baker/unwrap/atlas.h"

namespace luxel {

/// For points that rounding has put into an uncovered texel: the nearest of the eight around (x, y) on the chart's grid
/// that is covered, in a fixed order; no_patch if none is.
PatchNumber front_patch_near(const Chart& chart, const PatchSet& patches, std::uint32_t x, std::uint32_t y, float u,
                             float v);

/// Where on a page a point of the surface lies.
struct SurfaceTexel {
    const Chart* chart = nullptr;
    const PatchNumber* patch = nullptr;  ///< the texel's entry in PatchSet::page_patch
    std::uint32_t x = 0, y = 0;          ///< on the chart's grid
    float u = 0, v = 0;
};

/// At barycentrics (b1, b2: weights of corners 1 and 2) of a triangle. Does not read the texel, which is far from others in
/// memory: who needs many asks for all of them first.
inline SurfaceTexel surface_texel(const Atlas& atlas, const PatchSet& patches, std::uint32_t triangle, float b1, float b2) {
    SurfaceTexel at;
    at.chart = &atlas.charts[atlas.triangle_chart[triangle]];
    const Vec2f* uv = &atlas.corner_uv[std::size_t{3} * triangle];
    at.u = uv[0].x + b1 * (uv[1].x - uv[0].x) + b2 * (uv[2].x - uv[0].x);
    at.v = uv[0].y + b1 * (uv[1].y - uv[0].y) + b2 * (uv[2].y - uv[0].y);
    // Barycentrics may stick out a little; the far border belongs to the last texel.
    at.x = std::min(static_cast<std::uint32_t>(std::max(at.u, 0.0f)), at.chart->width - 1);
    at.y = std::min(static_cast<std::uint32_t>(std::max(at.v, 0.0f)), at.chart->height - 1);
    at.patch = &patches.page_patch[at.chart->page][std::size_t{at.chart->y + at.y} * patches.page_size + at.chart->x + at.x];
    return at;
}

/// y * page size + x of the texel.
inline std::size_t place_on_page(const PatchSet& patches, const SurfaceTexel& at) {
    return static_cast<std::size_t>(at.patch - patches.page_patch[at.chart->page].data());
}

/// Front patch at a point of a texel that `patches.parted` holds.
PatchNumber front_patch_of_parted(const PatchSet& patches, const SurfaceTexel& at);

/// Front patch there.
inline PatchNumber front_patch_at(const PatchSet& patches, const SurfaceTexel& at) {
    if (!patches.parted.empty() && patches.parted.holds(at.chart->page, place_on_page(patches, at))) return front_patch_of_parted(patches, at);
    return *at.patch != no_patch ? *at.patch : front_patch_near(*at.chart, patches, at.x, at.y, at.u, at.v);
}

/// Front patch at barycentrics of a triangle.
inline PatchNumber front_patch_at(const Scene&, const Atlas& atlas, const PatchSet& patches, std::uint32_t triangle,
                                  float b1, float b2) {
    return front_patch_at(patches, surface_texel(atlas, patches, triangle, b1, b2));
}

}  // namespace luxel
