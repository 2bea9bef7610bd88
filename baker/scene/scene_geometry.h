/// Triangles of one primitive of one node in world space, cleaned. A part of scene_build.
///
/// Units    metres relative to `origin`; unit normals.
/// Threads  pure functions.
/// Source   normals: the cofactor matrix, which is the inverse transpose up to a factor and exists for flat scales too.
#pragma once
#include "baker/scene/scene.h"

namespace luxel {

/// What lies farther than this from the origin of the file says nothing about where the scene is, and what lies half as far again from the
/// scene's own is dropped: floats hold the squares of areas up to there.
constexpr double farthest_m = 1.05e9;

struct ObjectGeometry {
    std::vector<Vec3f> positions, normals, shape_positions;  ///< of equal length
    std::array<std::vector<Vec2f>, 2> uv;                 ///< as long as positions
    std::vector<Rgba> colors;                             ///< the same, 0..1; empty where the file has none, or nothing but white
    std::vector<std::array<std::uint32_t, 3>> triangles;  ///< into positions
    std::vector<std::uint32_t> source_triangle;
    std::uint32_t not_finite_count = 0;   ///< triangles dropped: a corner is not finite or beyond farthest_m
    std::uint32_t no_area_count = 0;      ///< triangles dropped: no area
    std::uint32_t bad_normal_count = 0;   ///< vertices whose normal was zero or not finite
    std::uint32_t bad_uv_count = 0;       ///< vertices whose uv was not finite: zero is used
    std::uint32_t bad_color_count = 0;    ///< vertices whose colour was not within 0..1: the nearest that is, 0 for no number
    ShapeMetric metric{};
    std::array<double, 6> shape_root{};
    bool mirrored = false;
    bool is_painted = false;  ///< has colors
};

ObjectGeometry build_object_geometry(const PrimitiveRecord& primitive, const Matrix44d& world, const Vec3d& origin);

/// The origin for all floats: centre of the bounding box of all vertices within farthest_m, rounded to a power of two of at least
/// half and less than once the box's longest side; so it moves only when the scene's outer bounds do.
Vec3d scene_origin(const SceneRecord& record);

}  // namespace luxel
