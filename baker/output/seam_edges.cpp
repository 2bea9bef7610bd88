#include "baker/output/seam_edges.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <optional>
#include <tuple>

#include "baker/core/parallel.h"
#include "baker/output/edge_grid.h"

namespace luxel {
namespace {

/// Cosines of 8 and 60 degrees: see the header.
constexpr double smooth_cosine = 0.990268, fold_cosine = 0.5;
/// Of the largest coordinate: what two ways to compute one point may differ by.
constexpr double rounding = 0x1p-20;
/// Edges and overlaps below so many roundings are points.
constexpr double point_roundings = 8;
/// Texels between places that are the same place of a chart.
constexpr float same_place = 1.0f / 64;

/// An edge of a triangle, as 4 * triangle + corner.
using EdgeCode = std::uint64_t;
std::uint32_t triangle_of(EdgeCode code) { return static_cast<std::uint32_t>(code >> 2); }
int corner_of(EdgeCode code) { return static_cast<int>(code & 3); }
int after(int corner) { return corner == 2 ? 0 : corner + 1; }

/// An edge on the page, its two ends in an order of their own.
struct FlatEdge {
    std::array<std::uint32_t, 4> ends;  // bits of the coordinates, -0 as 0
    EdgeCode code;
    auto operator<=>(const FlatEdge&) const = default;
};

FlatEdge flat_edge(const Atlas& atlas, std::uint32_t triangle, int corner) {
    const auto end = [&](int k) {
        const Vec2f& uv = atlas.corner_uv[std::size_t{3} * triangle + static_cast<std::size_t>(k)];
        return std::pair(std::bit_cast<std::uint32_t>(uv.x + 0.0f), std::bit_cast<std::uint32_t>(uv.y + 0.0f));
    };
    const auto [low, high] = std::minmax({end(corner), end(after(corner))});
    return {{low.first, low.second, high.first, high.second}, 4 * EdgeCode{triangle} + static_cast<EdgeCode>(corner)};
}

/// Edges of a chart that no second triangle of it shares on the page.
std::vector<EdgeCode> chart_border(const Atlas& atlas, const Chart& chart) {
    std::vector<FlatEdge> edges;
    edges.reserve(std::size_t{3} * chart.count);
    for (std::uint32_t i = chart.first; i < chart.first + chart.count; ++i)
        for (int k = 0; k < 3; ++k) edges.push_back(flat_edge(atlas, atlas.chart_triangles[i], k));
    std::sort(edges.begin(), edges.end());
    std::vector<EdgeCode> border;
    for (std::size_t begin = 0, end = 0; begin < edges.size(); begin = end) {
        while (end < edges.size() && edges[end].ends == edges[begin].ends) ++end;
        if (end - begin == 1) border.push_back(edges[begin].code);
    }
    return border;
}

double largest_coordinate(const Scene& scene) {
    float largest = 0;
    for (const Vec3f& p : scene.positions)
        largest = std::max({largest, std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)});
    return static_cast<double>(largest);
}

/// Edges of all borders in order of their codes, those too short to be seen left out.
std::vector<EdgeCode> border_edges(const Scene& scene, const Atlas& atlas, double shortest_m) {
    std::vector<std::vector<EdgeCode>> of_chart(atlas.charts.size());
    parallel_for(atlas.charts.size(), 16, [&](std::size_t c) {
        of_chart[c] = chart_border(atlas, atlas.charts[c]);
        std::erase_if(of_chart[c], [&](EdgeCode code) {
            const Vec3d way = to_double(scene.corner(triangle_of(code), after(corner_of(code)))) -
                              to_double(scene.corner(triangle_of(code), corner_of(code)));
            return !(way.length() > shortest_m);
        });
    });
    std::vector<EdgeCode> all;
    for (auto& border : of_chart) {
        all.insert(all.end(), border.begin(), border.end());
        std::vector<EdgeCode>().swap(border);
    }
    std::sort(all.begin(), all.end());
    return all;
}

class SeamFinder {
  public:
    SeamFinder(const Scene& scene, const Atlas& atlas)
        : scene_(scene),
          atlas_(atlas),
          near_m_(rounding * largest_coordinate(scene)),
          edges_(border_edges(scene, atlas, point_roundings * near_m_)),
          grid_(segments(), near_m_) {}

    [[nodiscard]] std::vector<Seam> find() const {
        constexpr std::size_t range_edges = 4096;
        std::vector<std::vector<Seam>> parts((edges_.size() + range_edges - 1) / range_edges);
        parallel_ranges(edges_.size(), range_edges, [&](std::size_t range, std::size_t begin, std::size_t end) {
            for (std::size_t e = begin; e < end; ++e) add_seams(static_cast<std::uint32_t>(e), parts[range]);
        });
        std::vector<Seam> all;
        for (auto& part : parts) {
            all.insert(all.end(), part.begin(), part.end());
            std::vector<Seam>().swap(part);
        }
        return all;
    }

  private:
    [[nodiscard]] GridSegment segment(EdgeCode code) const {
        return {to_double(scene_.corner(triangle_of(code), corner_of(code))),
                to_double(scene_.corner(triangle_of(code), after(corner_of(code))))};
    }
    [[nodiscard]] std::vector<GridSegment> segments() const {
        std::vector<GridSegment> all(edges_.size());
        parallel_for(edges_.size(), 4096, [&](std::size_t e) { all[e] = segment(edges_[e]); });
        return all;
    }

    /// Those of an edge with longer ones.
    void add_seams(std::uint32_t edge, std::vector<Seam>& out) const {
        std::size_t partners = 0;
        for (const std::uint32_t other : grid_.longer_near(edge, seam_limits::most_candidates)) {
            if (partners == seam_limits::most_partners) break;
            if (const auto seam = seam_between(edges_[edge], edges_[other])) {
                out.push_back(*seam);
                ++partners;
            }
        }
    }

    /// `shorter` and `longer` as far as they overlap.
    [[nodiscard]] std::optional<Seam> seam_between(EdgeCode shorter, EdgeCode longer) const {
        const GridSegment s = segment(shorter), l = segment(longer);
        const Vec3d way = l.to - l.from;
        const double length = way.length();
        const Vec3d along = way / length;
        // Its far end comes first along the other, which runs against it.
        const double first = (s.to - l.from).dot(along), last = (s.from - l.from).dot(along);
        const double begin = std::max(0.0, first), end = std::min(length, last);
        if (!(end - begin > point_roundings * near_m_)) return {};
        const auto of_longer = [&](double at) { return at / length; };
        const auto of_shorter = [&](double at) { return (last - at) / (last - first); };
        for (const double at : {begin, end})
            if (!(((l.from + along * at) - (s.from + (s.to - s.from) * of_shorter(at))).length() <= near_m_)) return {};
        if (!is_smooth(shorter, of_shorter(begin), longer, of_longer(begin)) ||
            !is_smooth(shorter, of_shorter(end), longer, of_longer(end)))
            return {};
        const Seam seam{side(shorter, of_shorter(end), of_shorter(begin)),
                        side(longer, of_longer(end), of_longer(begin))};
        if (is_one_place(seam)) return {};
        return seam;
    }

    [[nodiscard]] Vec3d shading_normal_at(EdgeCode code, double t) const {
        const auto normal = [&](int k) { return to_double(scene_.corner_normal(triangle_of(code), static_cast<std::size_t>(k))); };
        return (normal(corner_of(code)) * (1 - t) + normal(after(corner_of(code))) * t).normalized();
    }
    [[nodiscard]] bool is_smooth(EdgeCode a, double at_a, EdgeCode b, double at_b) const {
        const Vec3d face_a = scene_.area_vector(triangle_of(a)).normalized(),
                    face_b = scene_.area_vector(triangle_of(b)).normalized();
        return shading_normal_at(a, at_a).dot(shading_normal_at(b, at_b)) >= smooth_cosine &&
               face_a.dot(face_b) >= fold_cosine;
    }

    [[nodiscard]] SeamSide side(EdgeCode code, double from, double to) const {
        const std::uint32_t triangle = triangle_of(code);
        const Vec2f begin = atlas_.page_uv(triangle, corner_of(code)),
                    end = atlas_.page_uv(triangle, after(corner_of(code)));
        const auto place = [&](double t) { return begin + (end - begin) * static_cast<float>(t); };
        return {triangle, static_cast<std::uint32_t>(corner_of(code)), place(from), place(to)};
    }
    [[nodiscard]] bool is_one_place(const Seam& seam) const {
        return atlas_.triangle_chart[seam.a.triangle] == atlas_.triangle_chart[seam.b.triangle] &&
               (seam.a.from - seam.b.from).length() < same_place && (seam.a.to - seam.b.to).length() < same_place;
    }

    const Scene& scene_;
    const Atlas& atlas_;
    const double near_m_;
    const std::vector<EdgeCode> edges_;
    const EdgeGrid grid_;
};

}  // namespace

std::vector<Seam> find_seams(const Scene& scene, const Atlas& atlas) { return SeamFinder(scene, atlas).find(); }

}  // namespace luxel
