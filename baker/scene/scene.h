/// The scene as every later stage sees it: clean triangles in world metres, materials, decoded textures, lamps.
/// Built once, then const but for `turned`, which is set before any stage asks for sides. Units: core/units.h.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "baker/core/vec.h"
#include "baker/scene/shape_metric.h"
#include "formats/base/hash.h"
#include "formats/gltf/scene_record.h"

namespace luxel {

/// Linear colour and alpha.
using Rgba = std::array<float, 4>;

/// Linear RGBA pixels, row 0 at the top (v = 0), as glTF's UV origin is the upper left corner.
struct Texture {
    std::uint32_t width = 0, height = 0;
    std::vector<Rgba> pixels;  ///< width * height
    WrapMode wrap_s = WrapMode::repeat, wrap_t = WrapMode::repeat;
    bool nearest = false;
};

struct Material {
    std::string name;
    Rgb reflectance{1, 1, 1};  ///< 0..1, times base texture
    float alpha = 1;
    std::uint32_t base_texture = none;  ///< index into Scene::textures
    int base_uv_set = 0;
    std::array<float, 6> base_transform{1, 0, 0, 0, 1, 0};  ///< TextureUse::transform
    Rgb emission{0, 0, 0};  ///< exitance M = pi * nits, lm/m2, times emissive texture
    std::uint32_t emissive_texture = none;
    int emissive_uv_set = 0;
    std::array<float, 6> emissive_transform{1, 0, 0, 0, 1, 0};
    /// opaque too where no alpha of the material lets anything through: what is left can be seen through somewhere.
    AlphaMode alpha_mode = AlphaMode::opaque;
    float alpha_cutoff = 0.5f;
    /// What passes through (see_through.h): the share of the surface that is a pane, 0..1, times red of its texture, and the
    /// colour of panes, 0..1, times base texture.
    float transmission = 0;
    std::uint32_t transmission_texture = none;
    int transmission_uv_set = 0;
    std::array<float, 6> transmission_transform{1, 0, 0, 0, 1, 0};
    Rgb pane_colour{1, 1, 1};
    bool blend_colours = false;  ///< light through a BLEND surface takes the colour of panes too

    [[nodiscard]] bool is_see_through() const { return alpha_mode != AlphaMode::opaque || transmission > 0; }
};

/// One primitive of one node: a run of triangles and vertices of the scene.
struct Object {
    std::string name;  ///< "node path, primitive p", for messages
    std::uint32_t instance = 0, primitive = 0;  ///< into SceneRecord: instances[], meshes[].primitives[]
    std::uint32_t material = 0;
    std::uint32_t first_triangle = 0, triangle_count = 0;
    std::uint32_t first_vertex = 0, vertex_count = 0;
    std::uint32_t first_color = none;  ///< of its vertex_count in Scene::colors; none: its vertices are white
    std::uint64_t path_hash = 0;     ///< of node path and primitive: stable when other nodes change
    std::uint64_t content_hash = 0;  ///< of the primitive's own arrays (local positions, normals, UVs, indices)
    ShapeMetric metric{};            ///< of the instance: with content_hash it says which objects show the same shape
    bool shares_node = false;        ///< a copy by EXT_mesh_gpu_instancing: node and materials are shared with others
    bool mirrored = false;           ///< negative determinant: winding was swapped so that fronts stay fronts
    /// As the material or, before it, the node's settings say (formats/gltf/node_settings.h, docs/settings.md).
    bool double_sided = false;
    bool casts = true;         ///< false: rays pass as if it were not there; its own texels receive light
    bool receives = true;      ///< false: it reflects nothing
    bool has_lightmap = true;  ///< false: its places on pages serve the computation alone
    float texels_per_metre = 0;  ///< 0: the scene's

    [[nodiscard]] bool is_painted() const { return first_color != none; }
    /// Texels per metre, where the scene has so many.
    [[nodiscard]] float density(float of_scene) const { return texels_per_metre > 0 ? texels_per_metre : of_scene; }
};

struct Lamp {
    LampKind kind = LampKind::point;
    std::string name;
    Vec3f position;       ///< relative to Scene::origin
    Vec3f direction;      ///< unit, where it shines to
    Rgb intensity;        ///< cd or lux
    float range = 0;      ///< metres, 0: unlimited
    float cos_inner = 1, cos_outer = 0.70710678f;
    float radius = 0;      ///< of point and spot, metres; 0: a point
    float sin_radius = 0;  ///< of directional: sine of half its apparent diameter, below 1; 0: parallel light
};

/// Light from outside of all surfaces: a picture of all directions by longitude and latitude, each pixel of one luminance.
///
/// Row 0 begins straight up (+Y), the last row ends straight down. Unturned, the middle of the picture is +X, a quarter of
/// its width to the right +Z, to the left -Z, its edges are -X: what three.js and Blender (exported to glTF) show.
struct SkyMap {
    std::uint32_t width = 0, height = 0;  ///< 0: there is no sky; 1 x 1: the same light from everywhere
    std::vector<Rgb> nits;                ///< width * height, >= 0
    double turn = 0;  ///< radians about +Y, counter-clockwise seen from above: where the picture is turned to

    [[nodiscard]] bool empty() const { return nits.empty(); }
};

struct Scene {
    Vec3d origin;  ///< world = origin + position
    std::vector<Vec3f> positions;
    /// Per vertex: the mesh in a frame of its own, the same bits for all copies (shape_metric.h), m.
    std::vector<Vec3f> shape_positions;
    std::vector<Vec3f> normals;  ///< unit shading normals per vertex; the geometric one where the file has none or a bad one
    std::array<std::vector<Vec2f>, 2> uv;  ///< per vertex, zero where the file has none
    /// Factors of base colour and alpha, 0..1, of the vertices of those objects that have any other than 1 (Object::first_color).
    std::vector<Rgba> colors;
    std::vector<std::array<std::uint32_t, 3>> triangles;  ///< counter-clockwise seen from the front
    /// Triangle of the source primitive (index into its indices / 3) for each triangle: dropped ones leave gaps.
    std::vector<std::uint32_t> source_triangle;
    std::vector<std::uint32_t> triangle_object;
    std::vector<Object> objects;
    std::vector<Material> materials;
    std::vector<Texture> textures;
    std::vector<Lamp> lamps;
    std::vector<std::string> dark_lamps;  ///< names of those without power; they are among `lamps` only if that was asked for
    std::uint32_t even_textures = 0;      ///< uses of textures of one colour that went into their material
    SkyMap sky;
    std::vector<bool> object_has_uv1;  ///< per object: did the file give TEXCOORD_1?

    /// Per triangle: what the file calls its back is the front of every later stage, which has the texels (light/lit_sides.h).
    /// Empty: of none.
    std::vector<bool> turned;

    /// Of triangles, objects (paths, contents), sidedness, and of what lets light through how much of which colour: what rays
    /// can meet.
    Key geometry_key;
    /// Of materials, textures, lamps and sky: what only the light depends on.
    Key light_key;

    [[nodiscard]] std::size_t triangle_count() const { return triangles.size(); }
    [[nodiscard]] const Vec3f& corner(std::uint32_t triangle, int k) const {
        return positions[triangles[triangle][static_cast<std::size_t>(k)]];
    }
    [[nodiscard]] const Object& object_of(std::uint32_t triangle) const { return objects[triangle_object[triangle]]; }
    /// Does light pass a triangle, in part or altogether?
    [[nodiscard]] bool is_see_through(std::uint32_t triangle) const { return !object_of(triangle).casts || material_of(triangle).is_see_through(); }
    [[nodiscard]] const Material& material_of(std::uint32_t triangle) const { return materials[object_of(triangle).material]; }
    [[nodiscard]] bool is_turned(std::uint32_t triangle) const { return !turned.empty() && turned[triangle]; }
    /// Cross product of two edges: twice the area times the geometric normal of the front. Never zero: such triangles are dropped.
    [[nodiscard]] Vec3d area_vector(std::uint32_t triangle) const {
        const Vec3d a = to_double(corner(triangle, 0));
        const Vec3d area = (to_double(corner(triangle, 1)) - a).cross(to_double(corner(triangle, 2)) - a);
        return is_turned(triangle) ? -area : area;
    }
    /// Shading normal of a corner, on the front.
    [[nodiscard]] Vec3f corner_normal(std::uint32_t triangle, std::size_t k) const {
        const Vec3f& normal = normals[triangles[triangle][k]];
        return is_turned(triangle) ? -normal : normal;
    }
    [[nodiscard]] double area_m2(std::uint32_t triangle) const { return 0.5 * area_vector(triangle).length(); }
    [[nodiscard]] Vec3f geometric_normal(std::uint32_t triangle) const {
        return to_float(area_vector(triangle).normalized());
    }
    /// Per axis the largest absolute coordinate of the corners, m: what the rounding error of any point made of them is
    /// bound by.
    [[nodiscard]] Vec3f corner_extent(std::uint32_t triangle) const {
        const Vec3f &a = corner(triangle, 0), &b = corner(triangle, 1), &c = corner(triangle, 2);
        const auto largest = [](float x, float y, float z) { return std::max({std::fabs(x), std::fabs(y), std::fabs(z)}); };
        return {largest(a.x, b.x, c.x), largest(a.y, b.y, c.y), largest(a.z, b.z, c.z)};
    }
    /// Resident bytes of all arrays: the geometry that --memory does not count.
    [[nodiscard]] std::uint64_t resident_bytes() const;
};

}  // namespace luxel
