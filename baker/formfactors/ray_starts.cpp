#include "baker/formfactors/ray_starts.h"

#include <algorithm>

#include "baker/core/ray_offset.h"

namespace luxel {
namespace {

constexpr float below_one = 0x1.fffffep-1f;

/// The last of ascending entries that begins at or before `at`, else the first.
std::uint32_t last_before(std::span<const float> begin, float at) {
    std::uint32_t chosen = 0;
    for (std::size_t k = 1; k < begin.size(); ++k) chosen += begin[k] <= at;
    return chosen;
}

/// On a piece that something cuts, where its place (s, t) in the unit square is.
Vec3f visible_point(const SurfaceSampler::Piece& piece, float s, float t) {
    const Vec2f place = onto_visible(piece.visible, s, t), b = piece.polygon.point(place.x, place.y);
    return piece.corner + piece.edge_1 * b.x + piece.edge_2 * b.y;
}

}  // namespace

RayStarts::RayStarts(const Scene& scene, const SurfaceSampler& sampler) : scene_(scene), sampler_(sampler) {
    if (sampler.flat()) return;
    for (const SurfaceSampler::Row& row : sampler.rows()) {
        const auto first = static_cast<std::uint32_t>(parts_.size());
        for (std::uint32_t p = row.first; p < row.end; ++p) add_piece(sampler.pieces()[p], sampler.piece_before()[p]);
        rows_.push_back({first, static_cast<std::uint32_t>(parts_.size()), 1 / row.share});
    }
}

void RayStarts::add_piece(const SurfaceSampler::Piece& piece, float before) {
    const std::uint32_t side = side_of(piece);
    const std::span<const Vec2f> corners = piece.polygon.corners();
    const auto away = [&](const Vec2f& b) { return piece.edge_1 * b.x + piece.edge_2 * b.y; };
    const auto add = [&](bool is_square, float begin, float width, const Vec2f& at, const Vec2f& along_1,
                         const Vec2f& along_2) {
        parts_.push_back({width > 0 ? 1 / width : 0.0f, is_square, side, nullptr,
                          piece.corner + away(at) + sides_[side].offset, away(along_1), away(along_2)});
        part_begin_.push_back(begin);
    };
    if (piece.visible != all_visible) {
        add(true, before, piece.share, {0, 0}, {0, 0}, {0, 0});
        parts_.back().cut = &piece;
        return;
    }
    if (corners.size() < 3) return add(true, before, piece.share, piece.polygon.centroid(), {0, 0}, {0, 0});
    if (piece.polygon.is_square())
        return add(true, before, piece.share, corners[0], corners[1] - corners[0], corners[3] - corners[0]);
    for (std::size_t k = 2; k < corners.size(); ++k) {
        const float up_to = k == 2 ? 0.0f : piece.polygon.area_up_to(k - 1);
        add(false, before + piece.share * up_to, piece.share * (piece.polygon.area_up_to(k) - up_to), corners[0],
            corners[k - 1] - corners[0], corners[k] - corners[0]);
    }
}

std::uint32_t RayStarts::side_of(const SurfaceSampler::Piece& piece) {
    if (sides_.empty() || sides_.back().triangle != piece.triangle)
        sides_.push_back({Frame(piece.normal),
                          piece.normal * offset_distance(piece.normal, scene_.corner_extent(piece.triangle)),
                          piece.triangle});
    return static_cast<std::uint32_t>(sides_.size() - 1);
}

void RayStarts::aim(const StartBatch& batch, std::size_t begin, std::size_t end, const RayArrays& out,
                    std::size_t to) const {
    if (sampler_.flat())
        aim_flat(batch, begin, end, out, to);
    else
        aim_parts(batch, begin, end, out, to);
}

void RayStarts::aim_flat(const StartBatch& b, std::size_t begin, std::size_t end, const RayArrays& out,
                         std::size_t to) const {
    const Parallelogram& flat = *sampler_.flat();
    const Frame frame(flat.normal);
    const Vec3f offset = flat.normal * offset_distance(flat.normal, scene_.corner_extent(flat.triangle));
    const std::size_t shift = to - begin;
    // Component by component, in the order of the vectors' own operations.
    const auto place = [&](float Vec3f::*c, std::span<float> component) {
        for (std::size_t k = begin; k < end; ++k)
            component[shift + k] =
                flat.origin.*c + flat.side_u.*c * b.points[0][k] + flat.side_v.*c * b.points[1][k] + offset.*c;
    };
    const auto turn = [&](float Vec3f::*c, std::span<float> component) {
        for (std::size_t k = begin; k < end; ++k)
            component[shift + k] = frame.tangent.*c * b.x[k] + frame.bitangent.*c * b.y[k] + frame.normal.*c * b.z[k];
    };
    place(&Vec3f::x, out.origin_x), place(&Vec3f::y, out.origin_y), place(&Vec3f::z, out.origin_z);
    turn(&Vec3f::x, out.direction_x), turn(&Vec3f::y, out.direction_y), turn(&Vec3f::z, out.direction_z);
    std::fill_n(out.from_triangle.begin() + static_cast<std::ptrdiff_t>(to), end - begin, flat.triangle);
}

void RayStarts::aim_parts(const StartBatch& b, std::size_t begin, std::size_t end, const RayArrays& out,
                          std::size_t to) const {
    const std::span<const float> row_before = sampler_.row_before();
    for (std::size_t k = begin; k < end; ++k, ++to) {
        const float u = b.points[0][k], v = b.points[1][k];
        const std::uint32_t r = last_before(row_before, v);
        const Row& row = rows_[r];
        const std::uint32_t p =
            row.first + last_before(std::span(part_begin_).subspan(row.first, row.end - row.first), u);
        const Part& part = parts_[p];
        const float s = std::clamp((u - part_begin_[p]) * part.inverse_width, 0.0f, below_one);
        const float t = std::clamp((v - row_before[r]) * row.inverse_share, 0.0f, below_one);
        const Side& side = sides_[part.side];
        const Vec2f along = part.is_square ? Vec2f(s, t) : triangle_point(s, t);
        const Vec3f origin = part.cut ? visible_point(*part.cut, s, t) + side.offset
                                      : part.origin + part.side_1 * along.x + part.side_2 * along.y;
        const Vec3f direction = side.frame.to_world({b.x[k], b.y[k], b.z[k]});
        out.origin_x[to] = origin.x, out.origin_y[to] = origin.y, out.origin_z[to] = origin.z;
        out.direction_x[to] = direction.x, out.direction_y[to] = direction.y, out.direction_z[to] = direction.z;
        out.from_triangle[to] = side.triangle;
    }
}

}  // namespace luxel
