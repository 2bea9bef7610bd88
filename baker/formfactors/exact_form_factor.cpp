#include "baker/formfactors/exact_form_factor.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "baker/core/units.h"

namespace luxel {
namespace {

using Polygon = std::vector<Vec3d>;

/// Normal times area (Newell's method: every corner has the same say).
Vec3d area_vector(std::span<const Vec3d> polygon) {
    Vec3d sum(0, 0, 0);
    for (std::size_t k = 2; k < polygon.size(); ++k)
        sum += (polygon[k - 1] - polygon[0]).cross(polygon[k] - polygon[0]);
    return sum * 0.5;
}

Vec3d middle(std::span<const Vec3d> polygon) {
    Vec3d sum(0, 0, 0);
    for (const Vec3d& p : polygon) sum += p;
    return sum / static_cast<double>(polygon.size());
}

double largest_distance(std::span<const Vec3d> polygon, const Vec3d& from) {
    double most = 0;
    for (const Vec3d& p : polygon) most = std::max(most, (p - from).length());
    return most;
}

/// What lies in front of the plane; corners within `tolerance` of it are taken to lie on it. Nothing if all do.
/// Source: Sutherland and Hodgman, Reentrant Polygon Clipping, CACM 17(1) 1974.
Polygon in_front(std::span<const Vec3d> polygon, const Vec3d& on_plane, const Vec3d& normal, double tolerance) {
    std::vector<double> height;
    double highest = 0;
    for (const Vec3d& p : polygon) {
        const double h = (p - on_plane).dot(normal);
        height.push_back(std::fabs(h) <= tolerance ? 0 : h);
        highest = std::max(highest, height.back());
    }
    Polygon part;
    if (highest == 0) return part;
    for (std::size_t k = 0; k < polygon.size(); ++k) {
        const std::size_t next = k + 1 == polygon.size() ? 0 : k + 1;
        if (height[k] >= 0) part.push_back(polygon[k]);
        if ((height[k] > 0 && height[next] < 0) || (height[k] < 0 && height[next] > 0))
            part.push_back(polygon[k] + (polygon[next] - polygon[k]) * (height[k] / (height[k] - height[next])));
    }
    return part;
}

struct Edge {
    Vec3d start, direction;  ///< unit
    double length;
};

std::vector<Edge> edges_of(const Polygon& polygon) {
    std::vector<Edge> edges;
    for (std::size_t k = 0; k < polygon.size(); ++k) {
        const Vec3d along = polygon[k + 1 == polygon.size() ? 0 : k + 1] - polygon[k];
        const double length = along.length();
        if (length > 0) edges.push_back({polygon[k], along / length, length});
    }
    return edges;
}

/// Integral of ln |p - x| over the points x of the edge. With s along the edge from the foot of p and h its height over it:
/// s/2 ln(s2 + h2) - s + h atan(s / h).
double log_distance(const Edge& edge, const Vec3d& p) {
    const Vec3d from_start = p - edge.start;
    const double foot = from_start.dot(edge.direction), h = from_start.cross(edge.direction).length();
    const auto up_to = [h](double s) {
        const double squared = s * s + h * h;
        if (squared == 0) return 0.0;
        return 0.5 * s * std::log(squared) - s + h * std::atan2(s, h);
    };
    return up_to(edge.length - foot) - up_to(-foot);
}

/// Nodes in 0 .. 1 of the 15-point Kronrod rule on -1 .. 1, its weights, and those of the 7-point Gauss rule inside it.
constexpr std::array<double, 8> kronrod_node{0.991455371120812639, 0.949107912342758525, 0.864864423359769073, 0.741531185599394440,
                                             0.586087235467691130, 0.405845151377397167, 0.207784955007898468, 0};
constexpr std::array<double, 8> kronrod_weight{0.022935322010529225, 0.063092092629978553, 0.104790010322250184,
                                               0.140653259715525919, 0.169004726639267903, 0.190350578064785410,
                                               0.204432940075298892, 0.209482141084727828};
constexpr std::array<double, 8> gauss_weight{0, 0.129484966168869693, 0, 0.279705391489276668,
                                             0, 0.381830050505118945, 0, 0.417959183673469388};

/// Integral of f over begin .. end, halved until the two rules agree. The depth is enough for t ln t at an end.
template <class Function>
double integrate(const Function& f, double begin, double end, double tolerance, int depth = 30) {
    const double centre = (begin + end) / 2, half = (end - begin) / 2;
    double kronrod = 0, gauss = 0;
    for (std::size_t k = 0; k < kronrod_node.size(); ++k) {
        const double offset = half * kronrod_node[k];
        const double value = offset == 0 ? f(centre) : f(centre - offset) + f(centre + offset);
        kronrod += kronrod_weight[k] * value;
        gauss += gauss_weight[k] * value;
    }
    if (depth == 0 || std::fabs(kronrod - gauss) * half <= tolerance) return kronrod * half;
    return integrate(f, begin, centre, tolerance / 2, depth - 1) + integrate(f, centre, end, tolerance / 2, depth - 1);
}

/// Integral of ln r over both edges. The inner integral is not smooth at most where the outer edge passes an end of the
/// inner one or is nearest to it: those places become ends of pieces.
double log_distance(const Edge& outer, const Edge& inner) {
    std::array<double, 5> cut{0, outer.length, 0, 0, 0};
    const Vec3d between = inner.start - outer.start;
    cut[2] = between.dot(outer.direction);
    cut[3] = cut[2] + inner.length * inner.direction.dot(outer.direction);
    const double cosine = inner.direction.dot(outer.direction), sine2 = inner.direction.cross(outer.direction).length2();
    if (sine2 > 1e-20) cut[4] = (between.dot(outer.direction) - cosine * between.dot(inner.direction)) / sine2;
    for (double& at : cut) at = std::clamp(at, 0.0, outer.length);
    std::sort(cut.begin(), cut.end());
    double sum = 0;
    for (std::size_t k = 1; k < cut.size(); ++k)
        if (cut[k] > cut[k - 1])
            sum += integrate([&](double t) { return log_distance(inner, outer.start + outer.direction * t); }, cut[k - 1],
                             cut[k], 1e-13 * outer.length * inner.length);
    return sum;
}

double by_contours(const Polygon& a, const Polygon& b) {
    const auto edges_a = edges_of(a), edges_b = edges_of(b);
    double sum = 0;
    for (const Edge& edge_a : edges_a)
        for (const Edge& edge_b : edges_b) {
            const double cosine = edge_a.direction.dot(edge_b.direction);
            if (std::fabs(cosine) > 1e-15) sum += cosine * log_distance(edge_a, edge_b);
        }
    return sum / (2 * pi);
}

struct WeightedPoint {
    Vec3d at;
    double area;
};

/// Gauss points of a polygon: 8 x 8 on each triangle of its fan.
std::vector<WeightedPoint> area_points(const Polygon& polygon) {
    constexpr std::array<double, 4> node{0.1834346424956498, 0.5255324099163290, 0.7966664774136267, 0.9602898564975363};
    constexpr std::array<double, 4> weight{0.3626837833783620, 0.3137066458778873, 0.2223810344533745, 0.1012285362903763};
    std::array<double, 8> x{}, w{};
    for (std::size_t k = 0; k < 4; ++k)
        x[k] = 0.5 - 0.5 * node[k], x[k + 4] = 0.5 + 0.5 * node[k], w[k] = w[k + 4] = 0.5 * weight[k];
    std::vector<WeightedPoint> points;
    for (std::size_t k = 2; k < polygon.size(); ++k) {
        const Vec3d u = polygon[k - 1] - polygon[0], v = polygon[k] - polygon[k - 1];
        const double twice_area = u.cross(v).length();
        for (std::size_t i = 0; i < 8; ++i)
            for (std::size_t j = 0; j < 8; ++j)
                points.push_back({polygon[0] + (u + v * x[j]) * x[i], w[i] * w[j] * x[i] * twice_area});
    }
    return points;
}

double by_areas(const Polygon& a, const Vec3d& normal_a, const Polygon& b, const Vec3d& normal_b) {
    const auto points_a = area_points(a), points_b = area_points(b);
    double sum = 0;
    for (const WeightedPoint& p : points_a)
        for (const WeightedPoint& q : points_b) {
            const Vec3d way = q.at - p.at;
            const double squared = way.length2();
            sum -= p.area * q.area * way.dot(normal_a) * way.dot(normal_b) / (squared * squared);
        }
    return sum / pi;
}

}  // namespace

double polygon_area(std::span<const Vec3d> polygon) { return area_vector(polygon).length(); }

double exact_exchange_area(std::span<const Vec3d> a, std::span<const Vec3d> b) {
    if (a.size() < 3 || b.size() < 3) return 0;
    // Around the middle of both and in units of their extent, so that logarithms are of numbers about 1.
    const Vec3d centre = (middle(a) + middle(b)) / 2;
    const double extent = std::max(largest_distance(a, centre), largest_distance(b, centre));
    const double area_a = polygon_area(a), area_b = polygon_area(b);
    if (!(extent > 0 && area_a > 0 && area_b > 0)) return 0;
    const auto local = [&](std::span<const Vec3d> polygon) {
        Polygon moved;
        for (const Vec3d& p : polygon) moved.push_back((p - centre) / extent);
        return moved;
    };
    const Polygon whole_a = local(a), whole_b = local(b);
    const Vec3d normal_a = area_vector(a) / area_a, normal_b = area_vector(b) / area_b;
    const double tolerance = 1e-12 + 0x1p-50 * centre.length() / extent;
    const Polygon part_a = in_front(whole_a, middle(whole_b), normal_b, tolerance);
    const Polygon part_b = in_front(whole_b, middle(whole_a), normal_a, tolerance);
    if (part_a.size() < 3 || part_b.size() < 3) return 0;
    const Vec3d middle_a = middle(part_a), middle_b = middle(part_b);
    const double sizes = largest_distance(part_a, middle_a) + largest_distance(part_b, middle_b);
    const bool far = sizes < 0.25 * (middle_a - middle_b).length();
    const double shared = far ? by_areas(part_a, normal_a, part_b, normal_b) : by_contours(part_a, part_b);
    return std::max(0.0, shared) * extent * extent;
}

double exact_form_factor(std::span<const Vec3d> a, std::span<const Vec3d> b) {
    const double area = polygon_area(a);
    return area > 0 ? exact_exchange_area(a, b) / area : 0;
}

double exact_point_form_factor(const Vec3d& point, const Vec3d& normal, std::span<const Vec3d> polygon) {
    const double area = polygon_area(polygon);
    if (polygon.size() < 3 || !(area > 0)) return 0;
    if ((point - middle(polygon)).dot(area_vector(polygon)) <= 0) return 0;
    const double extent = largest_distance(polygon, point);
    const Polygon part = in_front(polygon, point, normal, 1e-14 * extent);
    double sum = 0;
    for (std::size_t k = 0; k < part.size(); ++k) {
        const Vec3d p = part[k] - point, q = part[k + 1 == part.size() ? 0 : k + 1] - point;
        const Vec3d across = p.cross(q);
        const double sine = across.length();
        if (sine > 0) sum += std::atan2(sine, p.dot(q)) * across.dot(normal) / sine;
    }
    return std::fabs(sum) / (2 * pi);
}

}  // namespace luxel
