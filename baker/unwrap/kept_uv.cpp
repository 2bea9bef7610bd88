#include "baker/unwrap/kept_uv.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace luxel {

namespace {

constexpr float slack = 1e-4f;  ///< exporters round

/// The layout as the file has it.
struct Layout {
    FlatChart chart;
    Vec2d low{0, 0}, high{0, 0};
    double uv_area = 0, area_m2 = 0;
};

Layout layout_of(const Scene& scene, const Object& object, const ObjectMesh& mesh) {
    Layout layout;
    FlatChart& chart = layout.chart;
    chart.triangles.resize(mesh.triangles.size());
    std::iota(chart.triangles.begin(), chart.triangles.end(), 0u);
    chart.corner_uv.resize(mesh.triangles.size());
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec2f& uv = scene.uv[1][scene.triangles[object.first_triangle + t][mesh_corner(object, k)]];
            const Vec2d at(uv.x, uv.y);
            if (t == 0 && k == 0) layout.low = layout.high = at;
            layout.low = {std::min(layout.low.x, at.x), std::min(layout.low.y, at.y)};
            layout.high = {std::max(layout.high.x, at.x), std::max(layout.high.y, at.y)};
            chart.corner_uv[t][k] = at;
        }
        layout.uv_area += 0.5 * std::abs(signed_area2(chart.corner_uv[t]));
        layout.area_m2 += mesh.area_m2(t);
    }
    return layout;
}

/// The tile of 1 x 1, at whole numbers, that the layout begins in.
Vec2d tile_of(const Layout& layout) { return {std::floor(layout.low.x + slack), std::floor(layout.low.y + slack)}; }

/// How much of it leaves that tile, and where; empty if nothing does.
std::string what_leaves(const Layout& layout) {
    const Vec2d tile = tile_of(layout);
    std::size_t outside = 0;
    Vec2d example(0, 0);
    for (const auto& uv : layout.chart.corner_uv) {
        const auto out = std::find_if(uv.begin(), uv.end(), [&](const Vec2d& p) { return p.x > tile.x + 1 + slack || p.y > tile.y + 1 + slack; });
        if (out == uv.end()) continue;
        if (outside++ == 0) example = *out;
    }
    if (!outside) return {};
    return fmt::format("{} of {} triangles leave the tile {:.0f}..{:.0f}, {:.0f}..{:.0f} that the layout begins in, for example at ({:.6g}, {:.6g})", outside,
                       layout.chart.triangles.size(), tile.x, tile.x + 1, tile.y, tile.y + 1, example.x, example.y);
}

}  // namespace

std::optional<FlatChart> kept_chart(const Scene& scene, const Object& object, const ObjectMesh& mesh,
                                    double samples_per_metre, std::string& why_not) {
    Layout layout = layout_of(scene, object, mesh);
    why_not = what_leaves(layout);
    if (!why_not.empty()) return std::nullopt;
    if (!(layout.uv_area > 1e-12)) {
        why_not = "the coordinates cover no area";
        return std::nullopt;
    }
    const double scale = std::sqrt(layout.area_m2 / layout.uv_area);
    for (auto& uv : layout.chart.corner_uv)
        for (Vec2d& p : uv) p = (p - layout.low) * scale;
    const Overlap overlap = find_overlap(layout.chart, samples_per_metre);
    constexpr double most_overlap = 1e-3;  // of what is covered: neighbours that rounding has put over each other
    if (static_cast<double>(overlap.overlapped) > most_overlap * static_cast<double>(overlap.covered)) {
        const Vec2d at = overlap.at / scale + layout.low;
        const std::array<std::uint32_t, 2> source{scene.source_triangle[object.first_triangle + overlap.example[0]],
                                                  scene.source_triangle[object.first_triangle + overlap.example[1]]};
        why_not = fmt::format("{} of {} triangles overlap others, on {:.2g} % of the area that is covered, for example triangles {} and {} of the primitive at ({:.6g}, {:.6g})",
                              overlap.triangles, mesh.triangles.size(),
                              100 * static_cast<double>(overlap.overlapped) / static_cast<double>(overlap.covered), source[0], source[1], at.x, at.y);
        return std::nullopt;
    }
    return std::move(layout.chart);
}

}  // namespace luxel
