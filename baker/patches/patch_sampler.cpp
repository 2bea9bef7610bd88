#include "baker/patches/patch_sampler.h"

#include <algorithm>
#include <cmath>

namespace luxel {
namespace {

/// The last entry that begins at or before `at`; entries without a share are never chosen by a point inside a share.
template <class Entry>
const Entry& pick(std::span<const Entry> entries, float at) {
    const auto after = std::upper_bound(entries.begin(), entries.end(), at,
                                        [](float value, const Entry& entry) { return value < entry.share_before; });
    return after == entries.begin() ? entries.front() : *(after - 1);
}

/// Where in [0, 1) the point lies inside the entry.
template <class Entry>
float place_in(const Entry& entry, float at) {
    constexpr float below_one = 0x1.fffffep-1f;
    return std::clamp((at - entry.share_before) / entry.share, 0.0f, below_one);
}

}  // namespace

SurfaceSampler::SurfaceSampler(const Scene& scene, const Atlas& atlas, std::span<const Fragment> fragments, bool back)
    : scene_(scene), back_(back) {
    is_flat_ = make_flat(atlas, fragments);
    if (!is_flat_) cut_pieces(atlas, fragments);
}

bool SurfaceSampler::make_flat(const Atlas& atlas, std::span<const Fragment> fragments) {
    const Fragment &first = fragments.front(), &last = fragments.back();
    const std::size_t width = std::size_t{last.x} - first.x + 1u, height = std::size_t{last.y} - first.y + 1u;
    if (last.x < first.x || fragments.size() != width * height) return false;
    for (const Fragment& fragment : fragments)
        if (fragment.triangle != first.triangle) return false;
    // Barycentrics over the chart's grid are affine: b = b(0, 0) + x * db/dx + y * db/dy.
    const Vec2f* uv = &atlas.corner_uv[std::size_t{3} * first.triangle];
    const double ax = static_cast<double>(uv[1].x) - static_cast<double>(uv[0].x);
    const double ay = static_cast<double>(uv[1].y) - static_cast<double>(uv[0].y);
    const double bx = static_cast<double>(uv[2].x) - static_cast<double>(uv[0].x);
    const double by = static_cast<double>(uv[2].y) - static_cast<double>(uv[0].y);
    const double determinant = ax * by - ay * bx;
    if (!(std::fabs(determinant) > 1e-12)) return false;
    const Chart& chart = atlas.charts[atlas.triangle_chart[first.triangle]];
    const double x = first.x - chart.x - static_cast<double>(uv[0].x), y = first.y - chart.y - static_cast<double>(uv[0].y);
    const double w = static_cast<double>(width), h = static_cast<double>(height);
    const double b1 = (x * by - y * bx) / determinant, b2 = (ax * y - ay * x) / determinant;
    const double b1_u = w * by / determinant, b2_u = -w * ay / determinant;
    const double b1_v = -h * bx / determinant, b2_v = h * ax / determinant;
    for (int corner = 0; corner < 4; ++corner) {
        const double p = b1 + (corner & 1) * b1_u + (corner >> 1) * b1_v;
        const double q = b2 + (corner & 1) * b2_u + (corner >> 1) * b2_v;
        if (p < 0 || q < 0 || p + q > 1) return false;
    }
    const auto vector = [](double p, double q) { return Vec2f(static_cast<float>(p), static_cast<float>(q)); };
    const Vec3f& corner = scene_.corner(first.triangle, 0);
    const Vec3f edge_1 = scene_.corner(first.triangle, 1) - corner, edge_2 = scene_.corner(first.triangle, 2) - corner;
    flat_.triangle = first.triangle;
    flat_.normal = scene_.geometric_normal(first.triangle) * (back_ ? -1.0f : 1.0f);
    flat_.barycentric = vector(b1, b2);
    flat_.barycentric_u = vector(b1_u, b2_u);
    flat_.barycentric_v = vector(b1_v, b2_v);
    flat_.origin = corner + edge_1 * flat_.barycentric.x + edge_2 * flat_.barycentric.y;
    flat_.side_u = edge_1 * flat_.barycentric_u.x + edge_2 * flat_.barycentric_u.y;
    flat_.side_v = edge_1 * flat_.barycentric_v.x + edge_2 * flat_.barycentric_v.y;
    return true;
}

void SurfaceSampler::cut_pieces(const Atlas& atlas, std::span<const Fragment> fragments) {
    double total = 0;
    for (const Fragment& fragment : fragments) total += static_cast<double>(fragment.area_m2);
    pieces_.reserve(fragments.size());
    double before = 0;
    for (std::size_t begin = 0; begin < fragments.size();) {
        std::size_t end = begin;
        double row_area = 0;
        for (; end < fragments.size() && fragments[end].y == fragments[begin].y; ++end)
            row_area += static_cast<double>(fragments[end].area_m2);
        const auto first = static_cast<std::uint32_t>(pieces_.size());
        double in_row = 0;
        for (std::size_t k = begin; k < end; ++k) {
            const double area = static_cast<double>(fragments[k].area_m2);
            const Vec3f normal = scene_.geometric_normal(fragments[k].triangle);
            pieces_.push_back({FragmentPolygon(scene_, atlas, fragments[k]), fragments[k].triangle,
                               back_ ? -normal : normal, static_cast<float>(in_row / row_area),
                               static_cast<float>(area / row_area)});
            in_row += area;
        }
        rows_.push_back({first, static_cast<std::uint32_t>(pieces_.size()), static_cast<float>(before / total),
                         static_cast<float>(row_area / total)});
        before += row_area;
        begin = end;
    }
}

SurfacePoint SurfaceSampler::point(float u, float v) const {
    if (is_flat_)
        return {flat_.origin + flat_.side_u * u + flat_.side_v * v, flat_.normal, flat_.triangle,
                flat_.barycentric + flat_.barycentric_u * u + flat_.barycentric_v * v};
    const Row& row = pick(std::span<const Row>(rows_), v);
    const Piece& piece = pick(std::span<const Piece>(pieces_).subspan(row.first, row.end - row.first), u);
    const Vec2f barycentric = piece.polygon.point(place_in(piece, u), place_in(row, v));
    return {surface_position(scene_, piece.triangle, barycentric), piece.normal, piece.triangle, barycentric};
}

Vec3f SurfaceSampler::shading_normal(const SurfacePoint& at) const {
    const Vec3f normal = luxel::shading_normal(scene_, at.triangle, at.barycentric);
    return back_ ? -normal : normal;
}

}  // namespace luxel
