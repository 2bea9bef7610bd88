#include "baker/unwrap/chart_shape.h"

#include <algorithm>
#include <cmath>

namespace luxel {
namespace {

Vec3d mean_normal(const ObjectMesh& mesh, const std::vector<std::uint32_t>& triangles) {
    Vec3d sum(0);
    for (const std::uint32_t t : triangles) sum += mesh.area_vector(t);
    if (sum.length() == 0) sum = mesh.area_vector(triangles.front());
    return sum.normalized();
}

double cross2(const Vec2d& a, const Vec2d& b) { return a.x * b.y - a.y * b.x; }

/// Andrew's monotone chain; counter-clockwise, without collinear points.
std::vector<Vec2d> convex_hull(std::vector<Vec2d> points) {
    const auto less = [](const Vec2d& a, const Vec2d& b) { return a.x != b.x ? a.x < b.x : a.y < b.y; };
    std::sort(points.begin(), points.end(), less);
    points.erase(std::unique(points.begin(), points.end()), points.end());
    if (points.size() < 3) return points;
    std::vector<Vec2d> hull(2 * points.size());
    std::size_t size = 0;
    const auto add = [&](const Vec2d& p, std::size_t keep) {
        while (size > keep && cross2(hull[size - 1] - hull[size - 2], p - hull[size - 1]) <= 0) --size;
        hull[size++] = p;
    };
    for (const Vec2d& p : points) add(p, 1);
    const std::size_t lower = size;
    for (auto p = points.rbegin() + 1; p != points.rend(); ++p) add(*p, lower);
    hull.resize(size - 1);
    return hull;
}

struct Turn {
    Vec2d axis{1, 0};
    Vec2d extent{0, 0};
};

Turn turn_along(const std::vector<Vec2d>& hull, const Vec2d& axis) {
    Vec2d low(0), high(0);
    for (std::size_t i = 0; i < hull.size(); ++i) {
        const Vec2d p(hull[i].dot(axis), cross2(axis, hull[i]));
        if (i == 0) low = high = p;
        low = {std::min(low.x, p.x), std::min(low.y, p.y)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y)};
    }
    return {axis, high - low};
}

/// The hull edge along which the bounding box is smallest; of equals the one with the shorter box, then the longer
/// edge.
Turn best_turn(const std::vector<Vec2d>& hull) {
    std::vector<Vec2d> edges;
    for (std::size_t i = 0; i < hull.size(); ++i) edges.push_back(hull[(i + 1) % hull.size()] - hull[i]);
    std::stable_sort(edges.begin(), edges.end(),
                     [](const Vec2d& a, const Vec2d& b) { return a.length2() > b.length2(); });
    constexpr std::size_t edges_tried = 256;  // the longest ones matter; keeps round charts from costing a square
    if (edges.size() > edges_tried) edges.resize(edges_tried);
    Turn best;
    bool first = true;
    for (const Vec2d& edge : edges) {
        if (edge.length2() == 0) continue;
        const Turn turn = turn_along(hull, edge.normalized());
        const double area = turn.extent.x * turn.extent.y, best_area = best.extent.x * best.extent.y;
        const double side = std::max(turn.extent.x, turn.extent.y), best_side = std::max(best.extent.x, best.extent.y);
        // Differences below a millionth are rounding: copies of a mesh must choose alike.
        const bool smaller = area < best_area * (1 - 1e-6);
        const bool as_small = area < best_area * (1 + 1e-6) && side < best_side * (1 - 1e-6);
        if (first || smaller || as_small) best = turn;
        first = false;
    }
    return best;
}

/// Scanline fill at sample centres. Edges are evaluated from their lower end, so triangles that share one meet exactly.
class Sampler {
  public:
    /// As many samples as asked for, but not more than a bound that grows with the triangles of the chart.
    Sampler(const FlatChart& chart, double samples_per_metre) : scale_(samples_per_metre) {
        const Vec2d extent = extent_of(chart);
        const double most_samples = 4096 + 16.0 * static_cast<double>(chart.triangles.size());
        const double box = extent.x * extent.y, side = std::max(extent.x, extent.y);
        if (box * scale_ * scale_ > most_samples) scale_ = std::sqrt(most_samples / box);
        if (side * scale_ > most_samples) scale_ = most_samples / side;
        width_ = static_cast<std::size_t>(extent.x * scale_) + 1;
        height_ = static_cast<std::size_t>(extent.y * scale_) + 1;
    }
    [[nodiscard]] std::size_t count() const { return width_ * height_; }
    /// Where a sample lies in the chart's plane.
    [[nodiscard]] Vec2d place(std::size_t sample) const {
        return {(static_cast<double>(sample % width_) + 0.5) / scale_, (static_cast<double>(sample / width_) + 0.5) / scale_};
    }

    /// Calls visit(sample) for all samples inside a triangle.
    template <class Visit>
    void fill(const std::array<Vec2d, 3>& uv, const Visit& visit) const {
        double low = uv[0].y, high = uv[0].y;
        for (const Vec2d& p : uv) low = std::min(low, p.y), high = std::max(high, p.y);
        const long first = first_sample(low), last = std::min(first_sample(high), static_cast<long>(height_));
        for (long row = std::max(first, 0L); row < last; ++row) {
            const double y = (static_cast<double>(row) + 0.5) / scale_;
            double left = 0, right = 0;
            int crossings = 0;
            for (std::size_t k = 0; k < 3; ++k) {
                const Vec2d &p = uv[k], &q = uv[(k + 1) % 3];
                if ((p.y <= y) == (q.y <= y)) continue;
                const Vec2d &a = p.y < q.y ? p : q, &b = p.y < q.y ? q : p;
                const double x = a.x + (b.x - a.x) * ((y - a.y) / (b.y - a.y));
                if (crossings++ == 0)
                    left = right = x;
                else
                    left = std::min(left, x), right = std::max(right, x);
            }
            if (crossings != 2) continue;
            const long end = std::min(first_sample(right), static_cast<long>(width_));
            for (long x = std::max(first_sample(left), 0L); x < end; ++x) visit(static_cast<std::size_t>(row) * width_ + static_cast<std::size_t>(x));
        }
    }

  private:
    [[nodiscard]] long first_sample(double at) const { return static_cast<long>(std::ceil(at * scale_ - 0.5)); }
    double scale_;
    std::size_t width_ = 0, height_ = 0;
};

}  // namespace

FlatChart project_chart(const ObjectMesh& mesh, std::vector<std::uint32_t> triangles) {
    const Vec3d normal = mean_normal(mesh, triangles);
    const double sign = normal.z < 0 ? -1 : 1;  // Duff et al. 2017, as Frame in vec.h but in double
    const double a = -1 / (sign + normal.z), b = normal.x * normal.y * a;
    const Vec3d u(1 + sign * normal.x * normal.x * a, sign * b, -sign * normal.x);
    const Vec3d v(b, sign + normal.y * normal.y * a, -normal.y);
    const Vec3d origin = mesh.positions[mesh.triangles[triangles.front()][0]];
    FlatChart chart;
    chart.corner_uv.resize(triangles.size());
    for (std::size_t i = 0; i < triangles.size(); ++i)
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3d p = mesh.positions[mesh.triangles[triangles[i]][k]] - origin;
            chart.corner_uv[i][k] = {p.dot(u), p.dot(v)};
        }
    chart.triangles = std::move(triangles);
    return chart;
}

bool is_flat(const ObjectMesh& mesh, const std::vector<std::uint32_t>& triangles, double min_cosine) {
    const Vec3d normal = mean_normal(mesh, triangles);
    return std::all_of(triangles.begin(), triangles.end(),
                       [&](std::uint32_t t) { return mesh.area_vector(t).normalized().dot(normal) >= min_cosine; });
}

void restore_scale(const ObjectMesh& mesh, FlatChart& chart) {
    double area = 0, signed_uv = 0, gradient_u = 0, gradient_v = 0;
    for (std::size_t i = 0; i < chart.triangles.size(); ++i) {
        const auto& corners = mesh.triangles[chart.triangles[i]];
        const Vec3d e1 = mesh.positions[corners[1]] - mesh.positions[corners[0]];
        const Vec3d e2 = mesh.positions[corners[2]] - mesh.positions[corners[0]];
        const Vec2d d1 = chart.corner_uv[i][1] - chart.corner_uv[i][0],
                    d2 = chart.corner_uv[i][2] - chart.corner_uv[i][0];
        const double double_area = e1.cross(e2).length();
        // |grad u|^2 of the map from the surface to the plane, times the area: equal for u and v if it is conformal.
        const double e11 = e1.dot(e1), e12 = e1.dot(e2), e22 = e2.dot(e2);
        gradient_u += (d1.x * d1.x * e22 - 2 * d1.x * d2.x * e12 + d2.x * d2.x * e11) / double_area;
        gradient_v += (d1.y * d1.y * e22 - 2 * d1.y * d2.y * e12 + d2.y * d2.y * e11) / double_area;
        area += 0.5 * double_area;
        signed_uv += 0.5 * cross2(d1, d2);
    }
    if (!(gradient_u > 0) || !(gradient_v > 0) || signed_uv == 0) return;  // is_valid() will refuse it
    Vec2d scale(1 / std::sqrt(gradient_u), 1 / std::sqrt(gradient_v));
    scale *= std::sqrt(area / (std::abs(signed_uv) * scale.x * scale.y));
    if (signed_uv < 0) scale.x = -scale.x;
    for (auto& uv : chart.corner_uv)
        for (Vec2d& p : uv) p = {p.x * scale.x, p.y * scale.y};
}

void orient(FlatChart& chart) {
    std::vector<Vec2d> points;
    points.reserve(chart.corner_uv.size() * 3);
    for (const auto& uv : chart.corner_uv) points.insert(points.end(), uv.begin(), uv.end());
    const Turn turn = best_turn(convex_hull(std::move(points)));
    const bool tall = turn.extent.y > turn.extent.x * (1 + 1e-6);
    Vec2d low(0);
    bool first = true;
    for (auto& uv : chart.corner_uv)
        for (Vec2d& p : uv) {
            p = {p.dot(turn.axis), cross2(turn.axis, p)};
            if (tall) p = {p.y, -p.x};
            if (first) low = p;
            first = false;
            low = {std::min(low.x, p.x), std::min(low.y, p.y)};
        }
    for (auto& uv : chart.corner_uv)
        for (Vec2d& p : uv) p -= low;
}

Vec2d extent_of(const FlatChart& chart) {
    Vec2d extent(0);
    for (const auto& uv : chart.corner_uv)
        for (const Vec2d& p : uv) extent = {std::max(extent.x, p.x), std::max(extent.y, p.y)};
    return extent;
}

Coverage sample_coverage(const FlatChart& chart, double samples_per_metre) {
    const Sampler sampler(chart, samples_per_metre);
    std::vector<std::uint8_t> is_covered(sampler.count(), 0);
    Coverage coverage;
    for (const auto& uv : chart.corner_uv)
        sampler.fill(uv, [&](std::size_t sample) {
            ++(is_covered[sample] ? coverage.overlapped : coverage.covered);
            is_covered[sample] = 1;
        });
    return coverage;
}

Overlap find_overlap(const FlatChart& chart, double samples_per_metre) {
    const Sampler sampler(chart, samples_per_metre);
    std::vector<std::uint32_t> owner(sampler.count(), none);
    std::vector<bool> shares(chart.triangles.size()), is_shared(sampler.count());
    Overlap overlap;
    for (std::uint32_t t = 0; t < chart.corner_uv.size(); ++t)
        sampler.fill(chart.corner_uv[t], [&](std::size_t sample) {
            if (owner[sample] == none) {
                owner[sample] = t;
                ++overlap.covered;
                return;
            }
            if (overlap.overlapped == 0) overlap.example = {owner[sample], t}, overlap.at = sampler.place(sample);
            overlap.overlapped += !is_shared[sample];
            is_shared[sample] = true;
            shares[owner[sample]] = shares[t] = true;
        });
    overlap.triangles = static_cast<std::uint32_t>(std::count(shares.begin(), shares.end(), true));
    return overlap;
}

bool is_valid(const ObjectMesh& mesh, const FlatChart& chart, double samples_per_metre) {
    double area = 0;
    for (const std::uint32_t t : chart.triangles) area += mesh.area_m2(t);
    for (std::size_t i = 0; i < chart.triangles.size(); ++i) {
        const auto& uv = chart.corner_uv[i];
        const double flat = 0.5 * signed_area2(uv), world = mesh.area_m2(chart.triangles[i]);
        double longest2 = 0;
        for (std::size_t k = 0; k < 3; ++k) longest2 = std::max(longest2, (uv[(k + 1) % 3] - uv[k]).length2());
        // Written so that not-a-number fails. A sliver may turn over by rounding: it has no width to overlap with.
        if (!(flat >= -1e-3 * longest2) || !std::isfinite(longest2)) return false;
        constexpr double most_distortion = 32;  // of areas; beyond it texels say nothing about the surface
        const bool matters = world > 1e-6 * area;
        if (matters && (flat > most_distortion * world || flat * most_distortion < world)) return false;
    }
    return sample_coverage(chart, samples_per_metre).overlapped == 0;
}

}  // namespace luxel
