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

/// Front patch at barycentrics (b1, b2: weights of corners 1 and 2) of a triangle.
inline PatchNumber front_patch_at(const Scene&, const Atlas& atlas, const PatchSet& patches, std::uint32_t triangle,
                                  float b1, float b2) {
    const Chart& chart = atlas.charts[atlas.triangle_chart[triangle]];
    const Vec2f* uv = &atlas.corner_uv[std::size_t{3} * triangle];
    const float u = uv[0].x + b1 * (uv[1].x - uv[0].x) + b2 * (uv[2].x - uv[0].x);
    const float v = uv[0].y + b1 * (uv[1].y - uv[0].y) + b2 * (uv[2].y - uv[0].y);
    // Barycentrics may stick out a little; the far border belongs to the last texel.
    const std::uint32_t x = std::min(static_cast<std::uint32_t>(std::max(u, 0.0f)), chart.width - 1);
    const std::uint32_t y = std::min(static_cast<std::uint32_t>(std::max(v, 0.0f)), chart.height - 1);
    const PatchNumber patch =
        patches.page_patch[chart.page][std::size_t{chart.y + y} * patches.page_size + chart.x + x];
    return patch != no_patch ? patch : front_patch_near(chart, patches, x, y, u, v);
}

}  // namespace luxel
