#include "baker/patches/patch_sampler.h"

#include <algorithm>

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
            const Vec3f normal = scene.geometric_normal(fragments[k].triangle);
            pieces_.push_back({FragmentPolygon(scene, atlas, fragments[k]), fragments[k].triangle,
                               back ? -normal : normal, static_cast<float>(in_row / row_area),
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
