/// A chart while it is being made: flattened triangles in metres, and the operations on its shape.
/// Pure and deterministic; double precision. Errors: none.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "baker/unwrap/object_mesh.h"

namespace luxel {

using Vec2d = Imath::V2d;

struct FlatChart {
    std::vector<std::uint32_t> triangles;         ///< of the ObjectMesh, ascending
    std::vector<std::array<Vec2d, 3>> corner_uv;  ///< per triangle: corners in the chart's plane, m
};

/// Twice the signed area.
inline double signed_area2(const std::array<Vec2d, 3>& uv) {
    const Vec2d a = uv[1] - uv[0], b = uv[2] - uv[0];
    return a.x * b.y - a.y * b.x;
}

/// The triangles projected along their mean normal.
FlatChart project_chart(const ObjectMesh& mesh, std::vector<std::uint32_t> triangles);

/// Are all normals within acos(min_cosine) of their mean?
bool is_flat(const ObjectMesh& mesh, const std::vector<std::uint32_t>& triangles, double min_cosine);

/// Removes a scale per axis and sets the chart's area to the triangles' area: the result is as close to isometric as
/// scales can make it. Orientation becomes positive.
void restore_scale(const ObjectMesh& mesh, FlatChart& chart);

/// Turns the chart so that its bounding box is small, its longer side along u, and its lower corner at (0, 0).
void orient(FlatChart& chart);

/// Upper corner of the bounding box; the lower one is (0, 0) after orient().
Vec2d extent_of(const FlatChart& chart);

/// How a chart covers a raster of sample points.
struct Coverage {
    std::uint64_t covered = 0;     ///< samples inside a triangle
    std::uint64_t overlapped = 0;  ///< samples that a second triangle covers too
};
/// Samples lie at the centres of squares of 1 / samples_per_metre, coarser where the chart would need more samples than
/// a bound that grows with its triangles.
Coverage sample_coverage(const FlatChart& chart, double samples_per_metre);

/// Where triangles of a chart lie on each other, by the same samples.
struct Overlap {
    std::uint64_t covered = 0, overlapped = 0;  ///< samples inside a triangle, inside more than one
    std::uint32_t triangles = 0;                ///< that share a sample with another
    std::array<std::uint32_t, 2> example{};     ///< two that share the first such sample, indexes into FlatChart::triangles
    Vec2d at{0, 0};                             ///< that sample, in the chart's plane
};
Overlap find_overlap(const FlatChart& chart, double samples_per_metre);

/// One side up, not torn or squeezed out of proportion, and no sample covered twice.
bool is_valid(const ObjectMesh& mesh, const FlatChart& chart, double samples_per_metre);

}  // namespace luxel
