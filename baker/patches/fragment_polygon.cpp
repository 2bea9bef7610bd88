#include "baker/patches/fragment_polygon.h"

#include <algorithm>
#include <cmath>

#include "baker/core/sampling.h"

namespace luxel {
namespace {

ClipPoint between(const ClipPoint& a, const ClipPoint& b, double t) {
    return {a.u + (b.u - a.u) * t, a.v + (b.v - a.v) * t, a.b1 + (b.b1 - a.b1) * t, a.b2 + (b.b2 - a.b2) * t};
}

/// The part between the lines low and high; the outermost texels of a chart are open to the outside.
ClipPolygon slab(ClipPolygon polygon, double ClipPoint::*axis, std::uint32_t cell, std::uint32_t cells) {
    ClipPolygon below, above;
    if (cell > 0) {
        cut_polygon(polygon, axis, cell, below, above);
        polygon = above;
    }
    if (cell + 1 < cells) {
        cut_polygon(polygon, axis, cell + 1.0, below, above);
        polygon = below;
    }
    return polygon;
}

/// Is it the whole texel, corner by corner?
bool is_whole_square(const ClipPolygon& polygon, std::uint32_t x, std::uint32_t y) {
    if (polygon.count != 4) return false;
    unsigned seen = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        const ClipPoint& p = polygon.points[i];
        const double u = p.u - x, v = p.v - y;
        constexpr double rounding = 1e-6;  // texels
        if (std::abs(u - std::round(u)) > rounding || std::abs(v - std::round(v)) > rounding) return false;
        if (u < -rounding || u > 1 + rounding || v < -rounding || v > 1 + rounding) return false;
        seen |= 1u << ((u > 0.5 ? 1 : 0) + (v > 0.5 ? 2 : 0));
    }
    return seen == 15;
}

}  // namespace

ClipPolygon whole_triangle(const Atlas& atlas, std::uint32_t triangle) {
    ClipPolygon polygon;
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec2f& uv = atlas.corner_uv[std::size_t{3} * triangle + k];
        polygon.add({uv.x, uv.y, k == 1 ? 1.0 : 0.0, k == 2 ? 1.0 : 0.0});
    }
    return polygon;
}

void cut_polygon(const ClipPolygon& polygon, double ClipPoint::*axis, double at, ClipPolygon& below,
                 ClipPolygon& above) {
    below.count = above.count = 0;
    for (std::size_t i = 0; i < polygon.count; ++i) {
        const ClipPoint &p = polygon.points[i], &q = polygon.points[i + 1 < polygon.count ? i + 1 : 0];
        const double dp = p.*axis - at, dq = q.*axis - at;
        if (dp <= 0) below.add(p);
        if (dp >= 0) above.add(p);
        if ((dp < 0 && dq > 0) || (dp > 0 && dq < 0)) {
            ClipPoint cut = between(p, q, dp / (dp - dq));
            cut.*axis = at;
            below.add(cut);
            above.add(cut);
        }
    }
    // A polygon that only touches the line lies on one side; one that lies on it altogether belongs below.
    const auto on_line = [&](const ClipPoint& p) { return p.*axis == at; };
    if (below.count < 3) below.count = 0;
    if (above.count < 3 ||
        (below.count && std::all_of(above.points.data(), above.points.data() + above.count, on_line)))
        above.count = 0;
}

ClipPolygon texel_polygon(const ClipPolygon& triangle, const Chart& chart, std::uint32_t x, std::uint32_t y) {
    return slab(slab(triangle, &ClipPoint::v, y, chart.height), &ClipPoint::u, x, chart.width);
}

FragmentPolygon::FragmentPolygon(const Scene&, const Atlas& atlas, const Fragment& fragment) {
    const Chart& chart = atlas.charts[atlas.triangle_chart[fragment.triangle]];
    const std::uint32_t x = fragment.x - chart.x, y = fragment.y - chart.y;
    const ClipPolygon polygon = texel_polygon(whole_triangle(atlas, fragment.triangle), chart, x, y);
    square_ = is_whole_square(polygon, x, y);
    const double whole = polygon.share();
    double sum = 0;
    double cx = 0, cy = 0;
    for (std::size_t i = 0; i < polygon.count; ++i) {
        const ClipPoint& p = polygon.points[i];
        corners_[count_++] = {static_cast<float>(p.b1), static_cast<float>(p.b2)};
        if (i < 2) continue;
        ClipPolygon fan;
        for (const std::size_t k : {std::size_t{0}, i - 1, i}) fan.add(polygon.points[k]);
        const double weight = whole > 0 ? fan.share() / whole : 1.0 / static_cast<double>(polygon.count - 2);
        sum += weight;
        area_up_to_[i] = static_cast<float>(sum);
        cx += weight * (fan.points[0].b1 + fan.points[1].b1 + fan.points[2].b1) / 3;
        cy += weight * (fan.points[0].b2 + fan.points[1].b2 + fan.points[2].b2) / 3;
    }
    if (count_) area_up_to_[count_ - 1] = 1;
    constexpr float third = 1.0f / 3;
    centroid_ = count_ >= 3 ? Vec2f(static_cast<float>(cx), static_cast<float>(cy)) : Vec2f(third, third);
}

Vec2f FragmentPolygon::point(float s, float t) const {
    if (count_ < 3) return centroid_;
    if (square_) return corners_[0] + (corners_[1] - corners_[0]) * s + (corners_[3] - corners_[0]) * t;
    // The fan triangle is chosen by s, which is then stretched over it again.
    std::size_t i = 2;
    while (i + 1 < count_ && s >= area_up_to_[i]) ++i;
    const float before = i == 2 ? 0.0f : area_up_to_[i - 1], width = area_up_to_[i] - before;
    const float inner = width > 0 ? std::clamp((s - before) / width, 0.0f, 0x1.fffffep-1f) : 0.5f;
    const Vec2f w = triangle_point(inner, t);
    return corners_[0] + (corners_[i - 1] - corners_[0]) * w.x + (corners_[i] - corners_[0]) * w.y;
}

Vec3f shading_normal(const Scene& scene, std::uint32_t triangle, const Vec2f& b) {
    const Vec3f normal = scene.corner_normal(triangle, 0) * (1 - b.x - b.y) + scene.corner_normal(triangle, 1) * b.x +
                         scene.corner_normal(triangle, 2) * b.y;
    const Vec3f geometric = scene.geometric_normal(triangle);
    const float length = normal.length();
    if (!(length > 1e-6f) || normal.dot(geometric) <= 0) return geometric;
    return normal / length;
}

}  // namespace luxel
