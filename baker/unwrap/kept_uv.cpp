#include "baker/unwrap/kept_uv.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace luxel {

std::optional<FlatChart> kept_chart(const Scene& scene, const Object& object, const ObjectMesh& mesh,
                                    double samples_per_metre, std::string& why_not) {
    FlatChart chart;
    chart.triangles.resize(mesh.triangles.size());
    std::iota(chart.triangles.begin(), chart.triangles.end(), 0u);
    chart.corner_uv.resize(mesh.triangles.size());
    double uv_area = 0, area = 0;
    std::uint64_t outside = 0;
    Vec2d low(1, 1);
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        bool inside = true;
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t vertex = scene.triangles[object.first_triangle + t][mesh_corner(object, k)];
            const Vec2f& uv = scene.uv[1][vertex];
            constexpr float slack = 1e-4f;  // exporters round
            inside = inside && uv.x >= -slack && uv.x <= 1 + slack && uv.y >= -slack && uv.y <= 1 + slack;
            chart.corner_uv[t][k] = {uv.x, uv.y};
            low = {std::min<double>(low.x, uv.x), std::min<double>(low.y, uv.y)};
        }
        if (!inside) ++outside;
        uv_area += 0.5 * std::abs(signed_area2(chart.corner_uv[t]));
        area += mesh.area_m2(t);
    }
    if (outside) {
        why_not = fmt::format("{} of {} triangles leave the square 0..1", outside, mesh.triangles.size());
        return std::nullopt;
    }
    if (!(uv_area > 1e-12)) {
        why_not = "the coordinates cover no area";
        return std::nullopt;
    }
    const double scale = std::sqrt(area / uv_area);
    for (auto& uv : chart.corner_uv)
        for (Vec2d& p : uv) p = (p - low) * scale;
    const Coverage coverage = sample_coverage(chart, samples_per_metre);
    if (static_cast<double>(coverage.overlapped) > 1e-3 * static_cast<double>(coverage.covered)) {
        why_not =
            fmt::format("{} of {} sample points are covered more than once", coverage.overlapped, coverage.covered);
        return std::nullopt;
    }
    return chart;
}

}  // namespace luxel
