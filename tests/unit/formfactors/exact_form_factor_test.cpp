/// The oracle against published closed forms, symmetry, and an independent integration of Lambert's formula.
/// C-11, C-13, C-14, C-15: Howell, A Catalog of Radiation Heat Transfer Configuration Factors; C-13 and C-15 are by Ehlert and
/// Smith, View Factors for Perpendicular and Parallel Rectangular Plates, J. Thermophysics and Heat Transfer 7(1) 1993.
#include "baker/formfactors/exact_form_factor.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "baker/core/units.h"

namespace luxel {
namespace {

using Polygon = std::vector<Vec3d>;

Polygon rectangle(const Vec3d& at, const Vec3d& u, const Vec3d& v) { return {at, at + u, at + u + v, at + v}; }

/// Faces up, z = 0.
Polygon floor_of(double x0, double x1, double y0, double y1) { return rectangle({x0, y0, 0}, {x1 - x0, 0, 0}, {0, y1 - y0, 0}); }
/// Faces down, at height z.
Polygon ceiling_of(double x0, double x1, double y0, double y1, double z) {
    return rectangle({x0, y0, z}, {0, y1 - y0, 0}, {x1 - x0, 0, 0});
}
/// In the plane x = 0, faces +x.
Polygon wall_of(double y0, double y1, double z0, double z1) { return rectangle({0, y0, z0}, {0, y1 - y0, 0}, {0, 0, z1 - z0}); }

/// Any orientation, place and size that keeps shapes alike.
Polygon moved(const Polygon& polygon, double scale, const Vec3d& shift) {
    const Vec3d n = Vec3d(1, 2, 3).normalized(), t = n.cross(Vec3d(0, 0, 1)).normalized(), b = n.cross(t);
    Polygon result;
    for (const Vec3d& p : polygon) result.push_back((t * p.x + b * p.y + n * p.z) * scale + shift);
    return result;
}

void expect_factor(const Polygon& a, const Polygon& b, double expected, double tolerance = 1e-9) {
    const double ratio = polygon_area(a) / polygon_area(b);
    EXPECT_NEAR(exact_form_factor(a, b), expected, tolerance);
    EXPECT_NEAR(exact_form_factor(b, a), expected * ratio, tolerance * std::max(1.0, ratio));
    for (const double scale : {1e-4, 1e5})
        EXPECT_NEAR(exact_form_factor(moved(a, scale, Vec3d(3, -1, 2) * scale), moved(b, scale, Vec3d(3, -1, 2) * scale)),
                    expected, tolerance);
}

/// C-11: identical facing rectangles x by y at distance 1.
double facing(double x, double y) {
    const double p = std::sqrt(1 + x * x), q = std::sqrt(1 + y * y);
    return 2 / (pi * x * y) * (std::log(std::sqrt(p * p * q * q / (1 + x * x + y * y))) + x * q * std::atan(x / q) +
                               y * p * std::atan(y / p) - x * std::atan(x) - y * std::atan(y));
}

/// C-14: from a rectangle of width w to one of height h at right angles, common edge of length 1.
double at_right_angle(double h, double w) {
    const double r = std::sqrt(h * h + w * w), hh = h * h, ww = w * w;
    return (w * std::atan(1 / w) + h * std::atan(1 / h) - r * std::atan(1 / r) +
            0.25 * (std::log((1 + ww) * (1 + hh) / (1 + ww + hh)) + ww * std::log(ww * (1 + ww + hh) / ((1 + ww) * (ww + hh))) +
                    hh * std::log(hh * (1 + hh + ww) / ((1 + hh) * (hh + ww))))) /
           (pi * w);
}

template <class Term>
double sum_of_corners(const std::array<double, 2>& x, const std::array<double, 2>& y, const std::array<double, 2>& eta,
                      const std::array<double, 2>& xi, const Term& term) {
    double sum = 0;
    for (std::size_t i = 0; i < 2; ++i)
        for (std::size_t j = 0; j < 2; ++j)
            for (std::size_t k = 0; k < 2; ++k)
                for (std::size_t l = 0; l < 2; ++l)
                    sum += ((i + j + k + l) % 2 ? -1 : 1) * term(x[i], y[j], eta[k], xi[l]);
    return sum / ((x[1] - x[0]) * (y[1] - y[0]));
}

TEST(ExactFormFactor, FacingSquares) {
    expect_factor(floor_of(0, 1, 0, 1), ceiling_of(0, 1, 0, 1, 1), 0.19982489569838743);
    EXPECT_NEAR(facing(1, 1), 0.19982489569838743, 1e-12);
}

TEST(ExactFormFactor, FacingRectangles) {
    for (const double x : {0.1, 0.5, 2.0, 30.0})
        for (const double y : {0.02, 1.0, 7.0})
            expect_factor(floor_of(0, x, 0, y), ceiling_of(0, x, 0, y, 1), facing(x, y), 1e-9);
}

TEST(ExactFormFactor, ShiftedParallelRectangles) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> place(-2, 2), size(0.2, 3);
    for (int round = 0; round < 20; ++round) {
        const double x0 = place(random), y0 = place(random), u0 = place(random), v0 = place(random), z = size(random);
        const std::array<double, 2> x{x0, x0 + size(random)}, y{y0, y0 + size(random)};
        const std::array<double, 2> xi{u0, u0 + size(random)}, eta{v0, v0 + size(random)};
        const double expected = sum_of_corners(x, y, eta, xi, [z](double a, double b, double e, double k) {
            const double dx = a - k, dy = b - e, p = std::sqrt(dx * dx + z * z), q = std::sqrt(dy * dy + z * z);
            return (dy * p * std::atan(dy / p) + dx * q * std::atan(dx / q) - z * z / 2 * std::log(dx * dx + dy * dy + z * z)) /
                   (2 * pi);
        });
        expect_factor(floor_of(x[0], x[1], y[0], y[1]), ceiling_of(xi[0], xi[1], eta[0], eta[1], z), expected);
    }
}

TEST(ExactFormFactor, SquaresWithCommonEdge) {
    expect_factor(floor_of(0, 1, 0, 1), wall_of(0, 1, 0, 1), 0.20004377607540316);
    EXPECT_NEAR(at_right_angle(1, 1), 0.20004377607540316, 1e-12);
    for (const double h : {0.05, 1.0, 12.0})
        for (const double w : {0.3, 4.0}) expect_factor(floor_of(0, w, 0, 1), wall_of(0, 1, 0, h), at_right_angle(h, w));
}

TEST(ExactFormFactor, PerpendicularRectanglesAnywhere) {
    std::mt19937 random(2);
    std::uniform_real_distribution<double> place(-2, 2), size(0.2, 3), gap(0.05, 1);
    for (int round = 0; round < 20; ++round) {
        // The last rounds touch: a part of an edge, or a corner.
        const double x0 = round < 12 ? gap(random) : 0, y0 = place(random);
        const double v0 = round == 19 ? y0 + 1 : place(random), w0 = round < 12 ? gap(random) : 0;
        const std::array<double, 2> x{x0, x0 + size(random)}, y{y0, round == 19 ? y0 + 1 : y0 + size(random)};
        const std::array<double, 2> xi{w0, w0 + size(random)}, eta{v0, v0 + size(random)};
        const double expected = sum_of_corners(x, y, eta, xi, [](double a, double b, double e, double k) {
            const double d = b - e, c2 = a * a + k * k, c = std::sqrt(c2);
            const double all = c2 + d * d;
            return (d * (c > 0 ? c * std::atan(d / c) : 0) - (all > 0 ? (c2 - d * d) / 4 * std::log(all) : 0)) / (2 * pi);
        });
        expect_factor(floor_of(x[0], x[1], y[0], y[1]), wall_of(eta[0], eta[1], xi[0], xi[1]), expected);
    }
}

/// Tilted planes with common edges: each face of a regular tetrahedron sends a third to each other one.
TEST(ExactFormFactor, InsideATetrahedron) {
    const Polygon corners{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
    const Polygon a{corners[0], corners[2], corners[1]}, b{corners[0], corners[1], corners[3]};
    const Vec3d normal = (a[1] - a[0]).cross(a[2] - a[0]);
    ASSERT_LT(normal.dot(a[0]), 0) << "faces the inside";
    expect_factor(a, b, 1.0 / 3);
}

/// Two long plates of equal width with a common edge at angle phi: 1 - sin(phi / 2) (Howell C-5), reached from below as the
/// reciprocal of the length.
TEST(ExactFormFactor, WedgesByAngle) {
    for (const double degrees : {5.0, 30.0, 60.0, 90.0, 120.0, 170.0}) {
        const double phi = degrees * pi / 180, expected = 1 - std::sin(phi / 2);
        const auto factor = [phi](double length) {
            const Polygon a = rectangle({0, 0, 0}, {1, 0, 0}, {0, length, 0});
            const Polygon b = rectangle({0, 0, 0}, {0, length, 0}, {std::cos(phi), 0, std::sin(phi)});
            return exact_form_factor(a, b);
        };
        const double near = factor(1000), far = factor(2000);
        EXPECT_LT(near, expected);
        EXPECT_NEAR(2 * far - near, expected, 2e-6) << degrees;
    }
}

/// Rows of closed convex bodies sum to one: every edge shared, every angle.
TEST(ExactFormFactor, ClosedBodiesSumToOne) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> place(-1, 1);
    for (int round = 0; round < 20; ++round) {
        Polygon corners;
        for (int k = 0; k < 4; ++k) corners.emplace_back(place(random), place(random), place(random));
        const double volume = (corners[1] - corners[0]).cross(corners[2] - corners[0]).dot(corners[3] - corners[0]);
        if (std::fabs(volume) < 0.05) continue;
        if (volume < 0) std::swap(corners[0], corners[1]);
        const std::array<Polygon, 4> faces{{{corners[0], corners[1], corners[2]},
                                            {corners[0], corners[3], corners[1]},
                                            {corners[0], corners[2], corners[3]},
                                            {corners[1], corners[3], corners[2]}}};
        for (std::size_t i = 0; i < 4; ++i) {
            double sum = 0;
            for (std::size_t j = 0; j < 4; ++j)
                if (i != j) sum += exact_form_factor(faces[i], faces[j]);
            EXPECT_NEAR(sum, 1, 1e-9) << round;
        }
    }
}

/// Mean of Lambert's point formula over the polygon: shares nothing with the contour integral but the clipping.
double mean_of_points(const Polygon& triangle, const Polygon& b, int cells) {
    const Vec3d normal = (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]).normalized();
    double sum = 0;
    for (int i = 0; i < cells; ++i)
        for (int j = 0; j < cells - i; ++j) {
            const auto at = [&](double u, double v) {
                return triangle[0] + (triangle[1] - triangle[0]) * (u / cells) + (triangle[2] - triangle[0]) * (v / cells);
            };
            sum += exact_point_form_factor(at(i + 1.0 / 3, j + 1.0 / 3), normal, b);
            if (j + 1 < cells - i) sum += exact_point_form_factor(at(i + 2.0 / 3, j + 2.0 / 3), normal, b);
        }
    return sum / (cells * cells);
}

TEST(ExactFormFactor, TrianglesAnywhereAgreeWithPoints) {
    std::mt19937 random(4);
    std::uniform_real_distribution<double> place(-1, 1);
    int seen = 0, cut = 0;
    for (int round = 0; round < 60; ++round) {
        Polygon a, b;
        for (int k = 0; k < 3; ++k) {
            a.emplace_back(place(random), place(random), place(random));
            b.emplace_back(place(random) + 2.2, place(random), place(random));
        }
        const double f = exact_form_factor(a, b);
        EXPECT_NEAR(f, mean_of_points(a, b, 40), 3e-5) << round;
        EXPECT_NEAR(exact_exchange_area(a, b), exact_exchange_area(b, a), 1e-10);
        const Polygon back{a[0], a[2], a[1]};
        seen += f > 1e-3;
        cut += f > 1e-6 && exact_form_factor(back, b) > 1e-6;
    }
    EXPECT_GT(seen, 10);
    EXPECT_GT(cut, 3) << "some planes must cut the other triangle for this to mean anything";
}

TEST(ExactFormFactor, CutByTheHorizon) {
    // Half of the wall lies below the floor's plane; half of the floor lies behind the wall's.
    expect_factor(floor_of(0, 1, 0, 1), wall_of(0, 1, -1, 1), 0.20004377607540316);
    expect_factor(floor_of(-1, 1, 0, 1), wall_of(0, 1, -3, 1), 0.20004377607540316 / 2);
    EXPECT_EQ(exact_form_factor(floor_of(-1, -0.1, 0, 1), wall_of(0, 1, 0, 1)), 0);
    EXPECT_EQ(exact_form_factor(floor_of(0, 1, 0, 1), floor_of(0, 1, 0, 1)), 0);
}

TEST(ExactFormFactor, CoplanarExchangesNothing) {
    for (const double shift : {0.0, 0.5, 1.0, 3.0}) {
        const Polygon a = moved(floor_of(0, 1, 0, 1), 7, {100, 200, 300});
        const Polygon b = moved(floor_of(shift, shift + 1, 0, 2), 7, {100, 200, 300});
        EXPECT_EQ(exact_form_factor(a, b), 0);
    }
    EXPECT_EQ(exact_form_factor({}, floor_of(0, 1, 0, 1)), 0);
    EXPECT_EQ(exact_form_factor(floor_of(0, 0, 0, 1), ceiling_of(0, 1, 0, 1, 1)), 0);
}

/// Far and small: cos cos A / (pi r2), the relative error going down with the size squared.
TEST(ExactFormFactor, TinyFarPolygons) {
    const Vec3d way(0.6, 0.0, 0.8);
    for (const double size : {0.3, 1e-2, 1e-4, 1e-7}) {
        const Polygon a = floor_of(-size / 2, size / 2, -size / 2, size / 2);
        const Polygon b = rectangle(way * 10 - Vec3d(size / 2, size / 2, 0), {0, size, 0}, {size, 0, 0});
        const double expected = way.z * way.z * size * size / (pi * 100);
        // The last term: what is left of the size when corners at a distance of 10 are rounded to doubles.
        EXPECT_NEAR(exact_form_factor(a, b) / expected, 1, size * size / 25 + 1e-12 + 1e-14 / size) << size;
    }
    // The two ways of integrating meet: what is computed as areas from afar is what contours give for the parts.
    const Polygon a = floor_of(0, 1, 0, 1);
    for (const double distance : {4.0, 5.0, 6.0, 7.0})
        expect_factor(a, ceiling_of(0, 1, 0, 1, distance), facing(1 / distance, 1 / distance), 1e-11);
}

TEST(PointFormFactor, KnownForms) {
    // Corner element under a rectangle: Howell B-3.
    const auto corner = [](double a, double b) {
        const double p = std::sqrt(1 + a * a), q = std::sqrt(1 + b * b);
        return (a / p * std::atan(b / p) + b / q * std::atan(a / q)) / (2 * pi);
    };
    const Vec3d up(0, 0, 1);
    EXPECT_NEAR(exact_point_form_factor({0, 0, 0}, up, ceiling_of(0, 2, 0, 3, 1)), corner(2, 3), 1e-14);
    EXPECT_NEAR(exact_point_form_factor({1, 1, 0}, up, ceiling_of(0, 2, 0, 2, 1)), 4 * corner(1, 1), 1e-14);
    EXPECT_EQ(exact_point_form_factor({1, 1, 0}, up, floor_of(0, 2, 0, 2)), 0);
    EXPECT_EQ(exact_point_form_factor({1, 1, 0}, -up, ceiling_of(0, 2, 0, 2, 1)), 0);
    // A wall whose lower half is under the horizon.
    EXPECT_NEAR(exact_point_form_factor({1, 0.5, 0}, up, wall_of(0, 1, -5, 1)),
                exact_point_form_factor({1, 0.5, 0}, up, wall_of(0, 1, 0, 1)), 1e-14);
}

}  // namespace
}  // namespace luxel
