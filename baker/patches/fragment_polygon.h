/// The exact shape of a fragment: the part of a triangle that lies in one texel, in barycentrics of the triangle.
///
/// Barycentrics are the weights (b1, b2) of corners 1 and 2. Cutting happens in barycentric space, so it is exact for
/// slivers and for triangles without area on the page: the parts of a triangle always make up the whole triangle.
/// Threads: pure functions. Errors: none.
#pragma once
#include <array>
#include <span>

#include "baker/patches/texels.h"
#include "baker/scene/scene.h"
#include "baker/unwrap/atlas.h"

namespace luxel {

/// A corner while cutting: chart-local texel coordinates and barycentrics.
struct ClipPoint {
    double u = 0, v = 0, b1 = 0, b2 = 0;
};

/// A convex polygon: a triangle cut by the four sides of a square has at most seven corners. Rounding may bend a sliver
/// so that a line crosses it more than twice: hence the room for more, and what would not fit even there is dropped.
struct ClipPolygon {
    static constexpr std::size_t most_corners = 16;
    std::array<ClipPoint, most_corners> points;
    std::size_t count = 0;

    void add(const ClipPoint& p) {
        if (count < most_corners) points[count++] = p;
    }
    /// Twice the area in barycentric coordinates: the share of the triangle's area.
    [[nodiscard]] double share() const {
        double sum = 0;
        for (std::size_t i = 2; i < count; ++i)
            sum += (points[i - 1].b1 - points[0].b1) * (points[i].b2 - points[0].b2) -
                   (points[i].b1 - points[0].b1) * (points[i - 1].b2 - points[0].b2);
        return sum < 0 ? -sum : sum;
    }
};

/// The triangle on its chart's grid.
ClipPolygon whole_triangle(const Atlas& atlas, std::uint32_t triangle);

/// Cuts at u = at (or v = at): `below` gets u <= at, `above` the rest; both share the new corners exactly.
void cut_polygon(const ClipPolygon& polygon, double ClipPoint::*axis, double at, ClipPolygon& below,
                 ClipPolygon& above);

/// What of the triangle lies in texel (x, y) of its chart's grid (not of the page). Coordinates on the far border of
/// the chart belong to its last texel.
ClipPolygon texel_polygon(const ClipPolygon& triangle, const Chart& chart, std::uint32_t x, std::uint32_t y);

/// A fragment as a set of points to sample.
class FragmentPolygon {
  public:
    FragmentPolygon(const Scene& scene, const Atlas& atlas, const Fragment& fragment);

    /// Uniform on the fragment for uniform s, t in [0, 1); returns (b1, b2). A whole square is mapped by the plain
    /// bilinear map, so strata of (s, t) stay strata of the surface.
    [[nodiscard]] Vec2f point(float s, float t) const;
    /// Corners, b1 in x and b2 in y.
    [[nodiscard]] std::span<const Vec2f> corners() const { return {corners_.data(), count_}; }
    [[nodiscard]] bool is_square() const { return square_; }
    /// Share of the area in the fan triangles (0, k - 1, k) up to corner k; 1 at the last corner.
    [[nodiscard]] float area_up_to(std::size_t corner) const { return area_up_to_[corner]; }
    /// Barycentrics of the centre of gravity.
    [[nodiscard]] Vec2f centroid() const { return centroid_; }

  private:
    std::array<Vec2f, ClipPolygon::most_corners> corners_;
    std::array<float, ClipPolygon::most_corners> area_up_to_{};  ///< share of the fan triangles 1..i, last is 1
    std::size_t count_ = 0;
    bool square_ = false;
    Vec2f centroid_;
};

inline FragmentPolygon fragment_polygon(const Scene& scene, const Atlas& atlas, const Fragment& fragment) {
    return {scene, atlas, fragment};
}

/// Position at barycentrics, relative to Scene::origin, m.
inline Vec3f surface_position(const Scene& scene, std::uint32_t triangle, const Vec2f& b) {
    const Vec3f& a = scene.corner(triangle, 0);
    return a + (scene.corner(triangle, 1) - a) * b.x + (scene.corner(triangle, 2) - a) * b.y;
}

/// Interpolated shading normal, unit; the geometric one where interpolation fails or turns away from the front.
Vec3f shading_normal(const Scene& scene, std::uint32_t triangle, const Vec2f& b);

}  // namespace luxel
