#include "baker/patches/patch_sampler.h"

#include <algorithm>
#include <cmath>

#include "baker/core/ray_offset.h"

namespace luxel {
namespace {

/// The last of ascending entries that begins at or before `at`, else the first; entries without a share are never chosen by a
/// point inside a share. They are few, and counting them all is faster than a search whose choices nobody can guess.
std::uint32_t pick(std::span<const float> before, float at) {
    std::uint32_t chosen = 0;
    for (std::size_t k = 1; k < before.size(); ++k) chosen += before[k] <= at;
    return chosen;
}

/// Where in [0, 1) the point lies inside an entry.
float place_in(float share_before, float share, float at) {
    constexpr float below_one = 0x1.fffffep-1f;
    return std::clamp((at - share_before) / share, 0.0f, below_one);
}

/// Texels of a page.
struct TexelBox {
    std::uint32_t x, y, width, height;
};

/// The map from the unit square over the box to the plane of a triangle. False for triangles without area on the page.
bool map_box(const Scene& scene, const Atlas& atlas, std::uint32_t triangle, const TexelBox& box, Parallelogram& out) {
    // Barycentrics over the chart's grid are affine: b = b(0, 0) + x * db/dx + y * db/dy.
    const Vec2f* uv = &atlas.corner_uv[std::size_t{3} * triangle];
    const double u0 = static_cast<double>(uv[0].x), v0 = static_cast<double>(uv[0].y);
    const double ax = static_cast<double>(uv[1].x) - u0, ay = static_cast<double>(uv[1].y) - v0;
    const double bx = static_cast<double>(uv[2].x) - u0, by = static_cast<double>(uv[2].y) - v0;
    const double determinant = ax * by - ay * bx;
    if (!(std::fabs(determinant) > 1e-12)) return false;
    const Chart& chart = atlas.charts[atlas.triangle_chart[triangle]];
    const double x = box.x - chart.x - u0, y = box.y - chart.y - v0, w = box.width, h = box.height;
    const auto pair = [&](double b1, double b2) {
        return Vec2f(static_cast<float>(b1 / determinant), static_cast<float>(b2 / determinant));
    };
    out.triangle = triangle;
    out.normal = scene.geometric_normal(triangle);
    out.barycentric = pair(x * by - y * bx, ax * y - ay * x);
    out.barycentric_u = pair(w * by, -w * ay);
    out.barycentric_v = pair(-h * bx, h * ax);
    const Vec3f& corner = scene.corner(triangle, 0);
    const Vec3f edge_1 = scene.corner(triangle, 1) - corner, edge_2 = scene.corner(triangle, 2) - corner;
    out.origin = corner + edge_1 * out.barycentric.x + edge_2 * out.barycentric.y;
    out.side_u = edge_1 * out.barycentric_u.x + edge_2 * out.barycentric_u.y;
    out.side_v = edge_1 * out.barycentric_v.x + edge_2 * out.barycentric_v.y;
    return true;
}

float largest(const Vec3f& v) { return std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)}); }

/// How far `other` gets off the plane of `flat` in the box, m.
float deviation_m(const Parallelogram& flat, const Parallelogram& other) {
    const float at_origin = (other.origin - flat.origin).dot(flat.normal), along_u = (other.side_u - flat.side_u).dot(flat.normal),
                along_v = (other.side_v - flat.side_v).dot(flat.normal);
    return std::max({std::fabs(at_origin), std::fabs(at_origin + along_u), std::fabs(at_origin + along_v),
                     std::fabs(at_origin + along_u + along_v)});
}

/// Does another triangle of the box continue the same plane, map and flat shading, up to the rounding of its corners? Across the
/// plane by no more than a quarter of what rays are moved off it, so that none of them can start behind the neighbour: that is
/// next to nothing for a plane through the origin along an axis, where corners are exact.
bool continues(const Scene& scene, const Atlas& atlas, const TexelBox& box, const Parallelogram& flat,
               std::uint32_t triangle) {
    Parallelogram other;
    if (!map_box(scene, atlas, triangle, box, other)) return false;
    const float tolerance_m =
        4 * 0x1p-24f * std::min(largest(scene.corner_extent(triangle)), largest(scene.corner_extent(flat.triangle)));
    if (largest(other.origin - flat.origin) > tolerance_m || largest(other.side_u - flat.side_u) > tolerance_m ||
        largest(other.side_v - flat.side_v) > tolerance_m)
        return false;
    if (deviation_m(flat, other) > 0.25f * offset_distance(flat.normal, scene.corner_extent(flat.triangle))) return false;
    for (const std::uint32_t t : {flat.triangle, triangle})
        for (std::size_t k = 0; k < 3; ++k)
            if (scene.corner_normal(t, k).dot(flat.normal) < flat_cosine) return false;
    return true;
}

/// What of the fragment is sampled, m2: the cells in the open stand for all of its visible area.
double sampled_m2(const Fragment& fragment) {
    return fragment.visible == none_visible ? 0 : static_cast<double>(fragment.visible_m2());
}

}  // namespace

SurfaceSampler::SurfaceSampler(const Scene& scene, const Atlas& atlas, std::span<const Fragment> fragments, bool back)
    : scene_(scene), back_(back) {
    is_flat_ = make_flat(atlas, fragments);
    if (!is_flat_) cut_pieces(atlas, fragments);
}

bool SurfaceSampler::make_flat(const Atlas& atlas, std::span<const Fragment> fragments) {
    TexelBox box{fragments.front().x, fragments.front().y, 1, static_cast<std::uint32_t>(fragments.back().y) + 1};
    std::uint32_t right = box.x;
    double area_m2 = 0;
    for (const Fragment& fragment : fragments) {
        if (fragment.visible != all_visible) return false;
        box.x = std::min<std::uint32_t>(box.x, fragment.x);
        right = std::max<std::uint32_t>(right, fragment.x);
        area_m2 += static_cast<double>(fragment.area_m2);
    }
    box.width = right - box.x + 1;
    box.height -= box.y;
    const std::uint32_t triangle = fragments.front().triangle;
    if (!map_box(scene_, atlas, triangle, box, flat_)) return false;
    // The whole box is surface when the areas say so.
    const double whole_m2 = to_double(flat_.side_u).cross(to_double(flat_.side_v)).length();
    if (std::fabs(area_m2 - whole_m2) > 1e-5 * whole_m2) return false;
    std::uint32_t checked = triangle;
    for (const Fragment& fragment : fragments) {
        if (fragment.triangle == checked) continue;
        checked = fragment.triangle;
        if (checked != triangle && !continues(scene_, atlas, box, flat_, checked)) return false;
    }
    if (back_) flat_.normal = -flat_.normal;
    return true;
}

void SurfaceSampler::cut_pieces(const Atlas& atlas, std::span<const Fragment> fragments) {
    double total = 0;
    for (const Fragment& fragment : fragments) total += sampled_m2(fragment);
    pieces_.reserve(fragments.size());
    double before = 0;
    for (std::size_t begin = 0; begin < fragments.size();) {
        std::size_t end = begin;
        double row_area = 0;
        for (; end < fragments.size() && fragments[end].y == fragments[begin].y; ++end)
            row_area += sampled_m2(fragments[end]);
        const auto first = static_cast<std::uint32_t>(pieces_.size());
        double in_row = 0;
        for (std::size_t k = begin; k < end; ++k) {
            const double area = sampled_m2(fragments[k]);
            if (area <= 0) continue;
            const std::uint32_t triangle = fragments[k].triangle;
            const Vec3f normal = scene_.geometric_normal(triangle), corner = scene_.corner(triangle, 0);
            pieces_.push_back({FragmentPolygon(scene_, atlas, fragments[k]), triangle, back_ ? -normal : normal, corner,
                               scene_.corner(triangle, 1) - corner, scene_.corner(triangle, 2) - corner,
                               fragments[k].visible, static_cast<float>(area / row_area)});
            piece_before_.push_back(static_cast<float>(in_row / row_area));
            in_row += area;
        }
        begin = end;
        if (row_area <= 0) continue;
        rows_.push_back({first, static_cast<std::uint32_t>(pieces_.size()), static_cast<float>(row_area / total)});
        row_before_.push_back(static_cast<float>(before / total));
        before += row_area;
    }
}

SurfacePoint SurfaceSampler::point(float u, float v) const {
    if (is_flat_)
        return {flat_.origin + flat_.side_u * u + flat_.side_v * v, flat_.normal, flat_.triangle,
                flat_.barycentric + flat_.barycentric_u * u + flat_.barycentric_v * v};
    const std::uint32_t r = pick(row_before_, v);
    const Row& row = rows_[r];
    const std::uint32_t p = row.first + pick(std::span(piece_before_).subspan(row.first, row.end - row.first), u);
    const Piece& piece = pieces_[p];
    const Vec2f place = onto_visible(piece.visible, place_in(piece_before_[p], piece.share, u), place_in(row_before_[r], row.share, v));
    const Vec2f barycentric = piece.polygon.point(place.x, place.y);
    return {piece.corner + piece.edge_1 * barycentric.x + piece.edge_2 * barycentric.y, piece.normal, piece.triangle, barycentric};
}

Vec3f SurfaceSampler::shading_normal(const SurfacePoint& at) const {
    const Vec3f normal = luxel::shading_normal(scene_, at.triangle, at.barycentric);
    return back_ ? -normal : normal;
}

std::optional<Vec3f> SurfaceSampler::one_shading_normal() const {
    if (!is_flat_) return {};
    // Normals are interpolated: where three corners of a parallelogram agree all points do.
    const Vec3f normal = shading_normal(point(0.5f, 0.5f));
    const auto agrees = [&](float u, float v) { return (shading_normal(point(u, v)) - normal).length2() < 1e-12f; };
    return agrees(0, 0) && agrees(0.999f, 0) && agrees(0, 0.999f) ? std::optional(normal) : std::nullopt;
}

float SurfaceSampler::reach_m(const Vec3f& place) const {
    float square = 0;
    const auto add = [&](const Vec3f& corner) { square = std::max(square, (corner - place).length2()); };
    if (is_flat_) {
        for (const float u : {0.0f, 1.0f})
            for (const float v : {0.0f, 1.0f}) add(flat_.origin + flat_.side_u * u + flat_.side_v * v);
    }
    for (const Piece& piece : pieces_)
        for (const Vec2f& b : piece.polygon.corners()) add(piece.corner + piece.edge_1 * b.x + piece.edge_2 * b.y);
    return std::sqrt(square);
}

}  // namespace luxel
