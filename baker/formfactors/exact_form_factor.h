/// Form factors between convex planar polygons in closed form, nothing in between: the oracle of tests and tables.
///
/// A polygon is a list of at least three corners in metres, convex and planar, counter-clockwise seen from its front. Only
/// the fronts exchange light: each polygon is cut to the front half space of the other, which for flat surfaces is exact.
/// Between the parts that are left the area integral becomes a double contour integral (Stokes),
///     G = A_a F_ab = 1/(2 pi) sum over edges of both, (d_a . d_b) * integral integral ln r ds dt,
/// whose inner integral along an edge has a closed form and whose outer one is integrated adaptively. It stays finite where
/// edges touch, cross or coincide. Polygons small against their distance lose digits in it; for them the plain area integral
/// is smooth, and is taken by Gauss points instead.
///
/// Accuracy: about 1e-10 of the smaller area. Shapes are relative to themselves: metres or millimetres make no difference.
/// Threads: pure functions. Errors: none; a polygon without area, or coplanar with the other, exchanges nothing.
/// Source: Sparrow, A New and Simpler Formulation for Radiative Angle Factors, J. Heat Transfer 85 (1963); Goral, Torrance,
/// Greenberg, Battaile, Modeling the Interaction of Light Between Diffuse Surfaces, SIGGRAPH 1984; a closed form of both
/// integrals, with dilogarithms, is in Schroeder and Hanrahan, On the Form Factor between Two Polygons, SIGGRAPH 1993.
#pragma once
#include <span>

#include "baker/core/vec.h"

namespace luxel {

/// G = A_a F_ab = A_b F_ba, m2.
double exact_exchange_area(std::span<const Vec3d> a, std::span<const Vec3d> b);

/// F_ab, 0 .. 1: the share of what leaves the front of `a` that meets the front of `b`.
double exact_form_factor(std::span<const Vec3d> a, std::span<const Vec3d> b);

/// The share of what leaves a small surface at `point` with unit normal `normal` that meets the front of `polygon`.
/// Source: Lambert, Photometria, 1760; Baum, Rushmeier, Winget, Improving Radiosity Solutions Through the Use of Analytically
/// Determined Form-Factors, SIGGRAPH 1989.
double exact_point_form_factor(const Vec3d& point, const Vec3d& normal, std::span<const Vec3d> polygon);

/// Area of a planar polygon, m2.
double polygon_area(std::span<const Vec3d> polygon);

}  // namespace luxel
