/// Scenes made by hand for tests of whole rooms: surfaces, a maker that goes through SceneRecord and build_scene as a
/// file would, and everything that stands between a scene and its evidence. Metres, Y up; deterministic.
#pragma once
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "baker/chunks/spatial_tiles.h"
#include "baker/patches/patch_build.h"
#include "baker/patches/patch_set.h"
#include "baker/patches/see_through_texels.h"
#include "baker/patches/texel_raster.h"
#include "baker/scene/scene_build.h"
#include "baker/trace/open_backs.h"
#include "baker/trace/texel_joints.h"
#include "baker/trace/tracer.h"
#include "baker/trace/visible_area.h"
#include "baker/unwrap/unwrap.h"
#include "tests/unit/unwrap/made_scene.h"

namespace luxel::test {

/// The parallelogram with corners a, a + u, a + v; its front is the side that u x v points to.
inline void add_quad(MadeMesh& mesh, const Vec3f& a, const Vec3f& u, const Vec3f& v) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (const Vec3f& p : {a, a + u, a + u + v, a + v}) mesh.positions.push_back(p);
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.triangles.push_back({first, first + 2, first + 3});
}

inline MadeMesh quad(const Vec3f& a, const Vec3f& u, const Vec3f& v) {
    MadeMesh mesh;
    add_quad(mesh, a, u, v);
    return mesh;
}

inline void append(MadeMesh& mesh, const MadeMesh& more) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), more.positions.begin(), more.positions.end());
    for (const auto& t : more.triangles) mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
}

/// The same surface seen from the other side.
inline MadeMesh turned(MadeMesh mesh) {
    for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
    return mesh;
}

inline MadeMesh moved(MadeMesh mesh, const Vec3f& by) {
    for (Vec3f& p : mesh.positions) p += by;
    return mesh;
}

inline MadeMesh scaled(MadeMesh mesh, float by) {
    for (Vec3f& p : mesh.positions) p *= by;
    return mesh;
}

/// The six walls of the box between `low` and `high`, fronts inwards.
inline MadeMesh room(const Vec3f& low, const Vec3f& high) {
    return moved(turned(box(high.x - low.x, high.y - low.y, high.z - low.z)), low);
}

/// An icosahedron with every triangle cut into four `levels` times, corners on the sphere; fronts outwards.
inline MadeMesh icosphere(int levels, float radius) {
    const float t = (1 + std::sqrt(5.0f)) / 2;
    MadeMesh mesh;
    mesh.positions = {{-1, t, 0},  {1, t, 0},  {-1, -t, 0}, {1, -t, 0}, {0, -1, t},  {0, 1, t},
                      {0, -1, -t}, {0, 1, -t}, {t, 0, -1},  {t, 0, 1},  {-t, 0, -1}, {-t, 0, 1}};
    mesh.triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                      {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                      {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
    for (int level = 0; level < levels; ++level) {
        std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
        const auto middle = [&](std::uint32_t a, std::uint32_t b) {
            const auto next = static_cast<std::uint32_t>(mesh.positions.size());
            const auto [at, is_new] = middles.try_emplace(std::minmax(a, b), next);
            if (is_new) mesh.positions.push_back((mesh.positions[a] + mesh.positions[b]) / 2);
            return at->second;
        };
        std::vector<std::array<std::uint32_t, 3>> finer;
        for (const auto& [a, b, c] : mesh.triangles) {
            const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
            finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
        }
        mesh.triangles = std::move(finer);
    }
    for (Vec3f& p : mesh.positions) p = p.normalized() * radius;
    return mesh;
}

/// A sphere of triangles between meridians and circles of latitude, two poles, corners on the sphere; fronts outwards.
inline MadeMesh uv_sphere(std::uint32_t meridians, std::uint32_t circles, float radius) {
    MadeMesh mesh;
    const auto corner = [&](std::uint32_t row, std::uint32_t column) {  // of the circles between the poles
        return row == 0 ? 0u : row == circles ? 1u : 2 + (row - 1) * meridians + column % meridians;
    };
    mesh.positions = {{0, radius, 0}, {0, -radius, 0}};
    constexpr float pi_f = 3.14159265f;
    for (std::uint32_t row = 1; row < circles; ++row)
        for (std::uint32_t column = 0; column < meridians; ++column) {
            const float down = pi_f * static_cast<float>(row) / static_cast<float>(circles),
                        around = 2 * pi_f * static_cast<float>(column) / static_cast<float>(meridians);
            mesh.positions.push_back(
                Vec3f(std::sin(down) * std::cos(around), std::cos(down), std::sin(down) * std::sin(around)) * radius);
        }
    for (std::uint32_t row = 0; row < circles; ++row)
        for (std::uint32_t column = 0; column < meridians; ++column) {
            const std::uint32_t a = corner(row, column), b = corner(row, column + 1), c = corner(row + 1, column + 1),
                                d = corner(row + 1, column);
            if (row > 0) mesh.triangles.push_back({a, b, c});
            if (row + 1 < circles) mesh.triangles.push_back({a, c, d});
        }
    return mesh;
}

/// `count` rooms of 4 x 2.5 x 4 m beside each other along x, walls of 0.25 m between them with a door of 1 x 2 m; room k
/// begins at x = 4.25 k and has its half of each passage.
inline std::vector<MadeMesh> rooms_in_a_row(int count) {
    const float end = 4, high = 2.5f, deep = 4, passage = 0.125f;
    const auto mirrored = [&](MadeMesh mesh) {
        for (Vec3f& p : mesh.positions) p.x = end - p.x;
        return turned(std::move(mesh));
    };
    MadeMesh solid_wall, door_wall;  // at x = end
    add_quad(solid_wall, {end, 0, 0}, {0, 0, deep}, {0, high, 0});
    const float door_low = 1.5f, door_high = 2.5f, door_top = 2;
    add_quad(door_wall, {end, 0, 0}, {0, 0, door_low}, {0, high, 0});  // beside the door
    add_quad(door_wall, {end, 0, door_high}, {0, 0, deep - door_high}, {0, high, 0});
    add_quad(door_wall, {end, door_top, door_low}, {0, 0, door_high - door_low}, {0, high - door_top, 0});
    add_quad(door_wall, {end, 0, door_low}, {0, 0, door_high - door_low}, {passage, 0, 0});
    add_quad(door_wall, {end, door_top, door_low}, {passage, 0, 0}, {0, 0, door_high - door_low});
    add_quad(door_wall, {end, 0, door_low}, {passage, 0, 0}, {0, door_top, 0});
    add_quad(door_wall, {end, 0, door_high}, {0, door_top, 0}, {passage, 0, 0});
    std::vector<MadeMesh> rooms;
    for (int k = 0; k < count; ++k) {
        MadeMesh mesh;
        add_quad(mesh, {0, 0, 0}, {0, 0, deep}, {end, 0, 0});     // floor
        add_quad(mesh, {0, high, 0}, {end, 0, 0}, {0, 0, deep});  // ceiling
        add_quad(mesh, {0, 0, 0}, {end, 0, 0}, {0, high, 0});     // z = 0
        add_quad(mesh, {0, 0, deep}, {0, high, 0}, {end, 0, 0});  // z = deep
        append(mesh, mirrored(k > 0 ? door_wall : solid_wall));
        append(mesh, k + 1 < count ? door_wall : solid_wall);
        rooms.push_back(moved(std::move(mesh), {(end + 2 * passage) * static_cast<float>(k), 0, 0}));
    }
    return rooms;
}

/// [0]: the room at x < 4 with its half of the passage, [1]: the one at x > 4.25.
inline std::vector<MadeMesh> two_rooms() { return rooms_in_a_row(2); }

struct MadeMaterial {
    std::array<double, 3> reflectance{0.5, 0.5, 0.5};
    std::array<double, 3> nits{0, 0, 0};
    bool double_sided = false;
};

/// Collects objects as a glTF reader would hand them over. Each has a node path and a material of its own.
class SceneMaker {
  public:
    SceneMaker& add(const std::string& path, const MadeMesh& mesh, const MadeMaterial& material = {},
                    const Vec3d& shift = Vec3d(0, 0, 0)) {
        PrimitiveRecord primitive;
        primitive.material = static_cast<int>(record_.materials.size());
        primitive.positions = mesh.positions;
        for (const auto& triangle : mesh.triangles)
            primitive.indices.insert(primitive.indices.end(), triangle.begin(), triangle.end());
        InstanceRecord instance;
        instance.node = instance.mesh = static_cast<int>(record_.meshes.size());
        instance.node_path = path;
        instance.world.setTranslation(shift);
        MaterialRecord surface;
        surface.name = path;
        for (std::size_t c = 0; c < 3; ++c) surface.base_color[c] = material.reflectance[c];
        surface.emission = material.nits;
        surface.double_sided = material.double_sided;
        record_.materials.push_back(surface);
        record_.meshes.push_back({path, {primitive}});
        record_.instances.push_back(instance);
        return *this;
    }
    SceneMaker& add_lamp(const LampRecord& lamp) {
        record_.lamps.push_back(lamp);
        return *this;
    }
    [[nodiscard]] Scene build() const {
        std::vector<Warning> warnings;
        return build_scene(record_, {}, {}, warnings);
    }
    SceneRecord& record() { return record_; }

  private:
    SceneRecord record_;
};

struct PrepareOptions {
    double texels_per_metre = 8;
    std::uint32_t patch_texels = 4;
    std::uint32_t page_size = 256;
    std::uint32_t chunk_patches = 256;
    InstanceMode instances = InstanceMode::share;
};

/// A scene with everything up to numbered patches, as the baker makes it. Stays where it is: the tracer refers to it.
struct Prepared {
    Scene scene;
    Atlas atlas;
    TexelSet texels;
    PatchSet patches;
    ChunkLayout layout;
    std::unique_ptr<Tracer> tracer;

    [[nodiscard]] std::vector<PatchId> ids() const {
        std::vector<PatchId> all;
        for (const Patch& patch : patches.patches) all.push_back(patch.id);
        return all;
    }
    [[nodiscard]] std::vector<double> area_m2() const {
        std::vector<double> all;
        for (const Patch& patch : patches.patches) all.push_back(static_cast<double>(patch.area_m2));
        return all;
    }
    /// Index of the object that a patch lies on.
    [[nodiscard]] std::uint32_t object_of(PatchNumber patch) const {
        return atlas.charts[patches.patches[patch].chart].object;
    }
    /// Node path given to SceneMaker::add.
    [[nodiscard]] const std::string& path_of(PatchNumber patch) const {
        return scene.materials[scene.objects[object_of(patch)].material].name;
    }
};

inline std::unique_ptr<Prepared> prepare(Scene scene, const PrepareOptions& options = {}) {
    auto made = std::make_unique<Prepared>();
    made->scene = std::move(scene);
    UnwrapOptions unwrapping;
    unwrapping.texels_per_metre = options.texels_per_metre;
    unwrapping.page_size = options.page_size;
    unwrapping.instances = options.instances;
    std::vector<Warning> warnings;
    made->atlas = unwrap(made->scene, unwrapping, warnings, {});
    made->texels = raster_texels(made->scene, made->atlas);
    made->tracer = std::make_unique<Tracer>(made->scene);
    find_visible_area(made->scene, made->atlas, *made->tracer,
                      2 * static_cast<float>(options.patch_texels) / made->atlas.texels_per_metre, made->texels);
    thin_see_through(made->scene, made->atlas, made->texels);
    find_texel_joints(made->scene, made->atlas, *made->tracer, made->texels);
    made->patches = build_patches(made->scene, made->atlas, made->texels, {options.patch_texels});
    const auto open = find_open_backs(made->scene, made->atlas, made->patches, *made->tracer);
    made->patches = add_back_sides(std::move(made->patches), open);
    Tiling tiling = tile_patches(made->patches, {options.chunk_patches});
    renumber(made->patches, tiling.new_number);
    made->layout = std::move(tiling.layout);
    return made;
}

}  // namespace luxel::test
