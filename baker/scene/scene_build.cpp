#include "baker/scene/scene_build.h"

#include <algorithm>

#include "baker/core/parallel.h"
#include "baker/scene/scene_geometry.h"
#include "baker/scene/scene_keys.h"
#include "baker/scene/scene_materials.h"
#include "baker/scene/scene_sky.h"

namespace luxel {

namespace {

/// What one object will take, found by building it once; it is built a second time into its place, which costs less
/// than holding every object twice.
struct ObjectSize {
    std::uint32_t instance = 0, primitive = 0;
    std::uint64_t vertex_count = 0, triangle_count = 0;
    std::uint32_t not_finite_count = 0, no_area_count = 0, bad_normal_count = 0, bad_uv_count = 0, bad_color_count = 0;
    bool mirrored = false, is_painted = false;
    ShapeMetric metric{};
};

const PrimitiveRecord& primitive_of(const SceneRecord& record, const ObjectSize& size) {
    const InstanceRecord& instance = record.instances[size.instance];
    return record.meshes[static_cast<std::size_t>(instance.mesh)].primitives[size.primitive];
}

std::vector<ObjectSize> measure_objects(const SceneRecord& record, const Vec3d& origin) {
    std::vector<ObjectSize> sizes;
    for (std::uint32_t i = 0; i < record.instances.size(); ++i) {
        const auto& primitives = record.meshes[static_cast<std::size_t>(record.instances[i].mesh)].primitives;
        for (std::uint32_t p = 0; p < primitives.size(); ++p) sizes.push_back({.instance = i, .primitive = p});
    }
    parallel_for(sizes.size(), 1, [&](std::size_t o) {
        ObjectSize& size = sizes[o];
        const ObjectGeometry built =
            build_object_geometry(primitive_of(record, size), record.instances[size.instance].world, origin);
        size.vertex_count = built.positions.size();
        size.triangle_count = built.triangles.size();
        size.not_finite_count = built.not_finite_count;
        size.no_area_count = built.no_area_count;
        size.bad_normal_count = built.bad_normal_count;
        size.bad_uv_count = built.bad_uv_count;
        size.bad_color_count = built.bad_color_count;
        size.mirrored = built.mirrored;
        size.is_painted = built.is_painted;
        size.metric = built.metric;
    });
    return sizes;
}

std::string object_name(const SceneRecord& record, const ObjectSize& size) {
    return record.instances[size.instance].node_path + ", primitive " +
           std::to_string(primitive_of(record, size).gltf_primitive);
}

void report_findings(const SceneRecord& record, const ObjectSize& size, const BuildOptions& options, std::vector<Warning>& warnings) {
    const std::uint32_t dropped = size.not_finite_count + size.no_area_count;
    if (dropped)
        warnings.push_back({"dropped-triangles", object_name(record, size),
                            std::to_string(dropped) + " of " + std::to_string(dropped + size.triangle_count) +
                                " triangles dropped: " + std::to_string(size.not_finite_count) +
                                " with corners that are not finite or beyond 1e9 m, " + std::to_string(size.no_area_count) + " without area"});
    if (size.bad_normal_count)
        warnings.push_back({"bad-normals", object_name(record, size),
                            std::to_string(size.bad_normal_count) + " vertices have no usable normal: that of the surface is used"});
    if (size.bad_uv_count)
        warnings.push_back({"bad-uv", object_name(record, size),
                            std::to_string(size.bad_uv_count) + " UV coordinates are not finite: (0, 0) is used"});
    if (size.bad_color_count)
        ValueCheck(options.bad_values, options.file, object_name(record, size), warnings)
            .fault("vertex-colours-clamped", "COLOR_0: " + std::to_string(size.bad_color_count) + " vertices have colours that are not within 0 to 1",
                   "the nearest that is");
}

void settle(const NodeSettings& settings, bool double_sided, Object& object) {
    object.double_sided = settings.two_sided.value_or(double_sided);
    object.casts = settings.cast_shadow.value_or(true);
    object.receives = settings.receive.value_or(true);
    object.has_lightmap = settings.lightmap.value_or(true) && object.receives;
    object.texels_per_metre = static_cast<float>(settings.texels_per_metre.value_or(0));
}

/// Numbers of vertices and triangles per object; objects without triangles are left out.
void lay_out_objects(const SceneRecord& record, const std::vector<ObjectSize>& sizes, const BuildOptions& options, Scene& scene,
                     std::vector<Warning>& warnings) {
    std::vector<std::vector<std::uint64_t>> content(record.meshes.size());
    for (std::size_t m = 0; m < record.meshes.size(); ++m)
        for (const PrimitiveRecord& primitive : record.meshes[m].primitives) content[m].push_back(content_hash_of(primitive));

    std::uint64_t vertex_count = 0, triangle_count = 0, color_count = 0;
    for (const ObjectSize& size : sizes) {
        report_findings(record, size, options, warnings);
        if (size.triangle_count == 0) continue;
        const InstanceRecord& instance = record.instances[size.instance];
        const PrimitiveRecord& primitive = primitive_of(record, size);
        if (vertex_count + size.vertex_count >= none || triangle_count + size.triangle_count >= none)
            throw Error(ErrorCode::bad_input, object_name(record, size),
                        "the scene has more vertices or triangles than 32-bit numbers can count", "bake it in parts");
        Object object;
        object.name = object_name(record, size);
        object.instance = size.instance;
        object.primitive = size.primitive;
        object.material = primitive.material >= 0 ? static_cast<std::uint32_t>(primitive.material)
                                                  : static_cast<std::uint32_t>(record.materials.size());
        object.first_triangle = static_cast<std::uint32_t>(triangle_count);
        object.triangle_count = static_cast<std::uint32_t>(size.triangle_count);
        object.first_vertex = static_cast<std::uint32_t>(vertex_count);
        object.vertex_count = static_cast<std::uint32_t>(size.vertex_count);
        if (size.is_painted) object.first_color = static_cast<std::uint32_t>(color_count), color_count += size.vertex_count;
        object.path_hash = path_hash_of(instance.node_path, primitive.gltf_primitive);
        object.content_hash = content[static_cast<std::size_t>(instance.mesh)][size.primitive];
        object.mirrored = size.mirrored;
        object.shares_node = instance.gpu_instance >= 0;
        settle(instance.settings, primitive.material >= 0 && record.materials[static_cast<std::size_t>(primitive.material)].double_sided, object);
        object.metric = size.metric;
        scene.objects.push_back(std::move(object));
        scene.object_has_uv1.push_back(!primitive.uv[1].empty());
        vertex_count += size.vertex_count;
        triangle_count += size.triangle_count;
    }
    scene.positions.resize(vertex_count);
    scene.normals.resize(vertex_count);
    scene.shape_positions.resize(vertex_count);
    for (auto& set : scene.uv) set.resize(vertex_count);
    scene.colors.resize(color_count);
    scene.triangles.resize(triangle_count);
    scene.source_triangle.resize(triangle_count);
    scene.triangle_object.resize(triangle_count);
}

void fill_objects(const SceneRecord& record, Scene& scene) {
    parallel_for(scene.objects.size(), 1, [&](std::size_t o) {
        const Object& object = scene.objects[o];
        const InstanceRecord& instance = record.instances[object.instance];
        const ObjectGeometry built = build_object_geometry(
            record.meshes[static_cast<std::size_t>(instance.mesh)].primitives[object.primitive], instance.world, scene.origin);
        std::ranges::copy(built.positions, scene.positions.begin() + object.first_vertex);
        std::ranges::copy(built.normals, scene.normals.begin() + object.first_vertex);
        std::ranges::copy(built.shape_positions, scene.shape_positions.begin() + object.first_vertex);
        for (std::size_t set = 0; set < 2; ++set)
            std::ranges::copy(built.uv[set], scene.uv[set].begin() + object.first_vertex);
        if (object.is_painted()) std::ranges::copy(built.colors, scene.colors.begin() + object.first_color);
        std::ranges::copy(built.source_triangle, scene.source_triangle.begin() + object.first_triangle);
        for (std::uint32_t t = 0; t < object.triangle_count; ++t) {
            auto triangle = built.triangles[t];
            for (std::uint32_t& vertex : triangle) vertex += object.first_vertex;
            scene.triangles[object.first_triangle + t] = triangle;
            scene.triangle_object[object.first_triangle + t] = static_cast<std::uint32_t>(o);
        }
    });
}

/// Who hides a lamp's glass from shadows may not know that its light is gone too.
void report_lost_emission(const Scene& scene, std::vector<Warning>& warnings) {
    for (const Object& object : scene.objects)
        if (!object.casts && scene.materials[object.material].emission != Rgb(0, 0, 0))
            warnings.push_back({"emission-left-out", object.name, "it casts no shadow, so light does not know of it: what it emits lights nothing"});
}

/// Textures need coordinates: viewers take (0, 0) for all, so does the scene, but that is seldom meant.
void report_missing_uv(const SceneRecord& record, const Scene& scene, std::vector<Warning>& warnings) {
    for (const Object& object : scene.objects) {
        const Material& material = scene.materials[object.material];
        const InstanceRecord& instance = record.instances[object.instance];
        const PrimitiveRecord& primitive =
            record.meshes[static_cast<std::size_t>(instance.mesh)].primitives[object.primitive];
        const auto lacks = [&](std::uint32_t texture, int uv_set) {
            return texture != none && primitive.uv[static_cast<std::size_t>(uv_set)].empty();
        };
        if (lacks(material.base_texture, material.base_uv_set) || lacks(material.emissive_texture, material.emissive_uv_set) ||
            lacks(material.transmission_texture, material.transmission_uv_set))
            warnings.push_back({"no-uv", object.name, "its material has a texture, but the mesh has no coordinates for it: "
                                                      "one pixel colours all of it"});
    }
}

/// Per material the least alpha of the vertices that show it; none: nothing does.
std::vector<std::optional<float>> least_alphas(const SceneRecord& record, const Scene& scene) {
    std::vector<std::optional<float>> least(record.materials.size() + 1);
    for (const Object& object : scene.objects) {
        std::optional<float>& alpha = least[object.material];
        if (!alpha) alpha = 1.0f;
        if (!object.is_painted()) continue;
        for (std::uint32_t k = 0; k < object.vertex_count; ++k) alpha = std::min(*alpha, scene.colors[object.first_color + k][3]);
    }
    return least;
}

}  // namespace

Scene build_scene(const SceneRecord& record, const ImageDecoder& decode, const BuildOptions& options,
                  std::vector<Warning>& warnings) {
    Scene scene;
    scene.origin = scene_origin(record);
    const std::vector<ObjectSize> sizes = measure_objects(record, scene.origin);
    lay_out_objects(record, sizes, options, scene, warnings);
    fill_objects(record, scene);

    build_materials(record, least_alphas(record, scene), decode, options, scene, warnings);
    report_missing_uv(record, scene, warnings);
    report_lost_emission(scene, warnings);
    build_lamps(record, options, scene, warnings);
    scene.sky = build_sky(record.sky, decode, options, warnings);
    scene.geometry_key = geometry_key_of(scene);
    scene.light_key = light_key_of(scene);
    return scene;
}

}  // namespace luxel
