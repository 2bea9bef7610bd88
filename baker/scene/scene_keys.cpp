#include "baker/scene/scene_keys.h"

#include "formats/base/bytes.h"

namespace luxel {

namespace {

void add_use(KeyBuilder& key, const Texture& texture, int uv_set, const std::array<float, 6>& transform) {
    key.integer(uv_set).array(std::span<const float>(transform)).integer(texture.width).integer(texture.height);
    key.integer(static_cast<int>(texture.wrap_s)).integer(static_cast<int>(texture.wrap_t)).integer(texture.nearest);
}

void add_alpha(KeyBuilder& key, const Scene& scene, const Material& material) {
    key.integer(static_cast<int>(material.alpha_mode));
    if (material.alpha_mode == AlphaMode::opaque) return;
    key.number(static_cast<double>(material.alpha)).number(static_cast<double>(material.alpha_cutoff));
    if (material.base_texture == none) return;
    const Texture& texture = scene.textures[material.base_texture];
    add_use(key, texture, material.base_uv_set, material.base_transform);
    std::vector<float> alpha;
    alpha.reserve(texture.pixels.size());
    for (const auto& pixel : texture.pixels) alpha.push_back(pixel[3]);
    key.bytes(bytes_of(alpha));
}

void add_rgb(KeyBuilder& key, const Rgb& value) {
    for (int c = 0; c < 3; ++c) key.number(static_cast<double>(value[c]));
}

}  // namespace

std::uint64_t path_hash_of(const std::string& node_path, int gltf_primitive) {
    return KeyBuilder("object path").text(node_path).integer(gltf_primitive).finish().low;
}

std::uint64_t content_hash_of(const PrimitiveRecord& primitive) {
    return KeyBuilder("primitive content")
        .bytes(bytes_of(primitive.positions))
        .bytes(bytes_of(primitive.normals))
        .bytes(bytes_of(primitive.uv[0]))
        .bytes(bytes_of(primitive.uv[1]))
        .bytes(bytes_of(primitive.indices))
        .finish()
        .low;
}

Key geometry_key_of(const Scene& scene) {
    KeyBuilder key("scene geometry");
    key.number(scene.origin.x).number(scene.origin.y).number(scene.origin.z);
    key.bytes(bytes_of(scene.positions)).bytes(bytes_of(scene.normals));
    key.bytes(bytes_of(scene.uv[0])).bytes(bytes_of(scene.uv[1]));
    key.bytes(bytes_of(scene.triangles)).bytes(bytes_of(scene.source_triangle)).bytes(bytes_of(scene.triangle_object));
    std::vector<Key> alpha_of_material;
    for (const Material& material : scene.materials) {
        KeyBuilder alpha("alpha");
        add_alpha(alpha, scene, material);
        alpha_of_material.push_back(alpha.finish());
    }
    for (std::size_t o = 0; o < scene.objects.size(); ++o) {
        const Object& object = scene.objects[o];
        key.integer(static_cast<std::int64_t>(object.path_hash)).integer(static_cast<std::int64_t>(object.content_hash));
        key.integer(object.first_triangle).integer(object.triangle_count).integer(scene.object_has_uv1[o]);
        key.integer(scene.materials[object.material].double_sided).key(alpha_of_material[object.material]);
    }
    return key.finish();
}

Key light_key_of(const Scene& scene) {
    KeyBuilder key("scene light");
    for (const Object& object : scene.objects) key.integer(object.material);
    for (const Material& material : scene.materials) {
        add_rgb(key, material.reflectance);
        add_rgb(key, material.emission);
        for (const bool emissive : {false, true}) {
            const std::uint32_t texture = emissive ? material.emissive_texture : material.base_texture;
            key.integer(texture);
            if (texture == none) continue;
            add_use(key, scene.textures[texture], emissive ? material.emissive_uv_set : material.base_uv_set,
                    emissive ? material.emissive_transform : material.base_transform);
        }
    }
    for (const Texture& texture : scene.textures) key.bytes(bytes_of(texture.pixels));
    for (const Lamp& lamp : scene.lamps) {
        key.integer(static_cast<int>(lamp.kind));
        add_rgb(key, lamp.intensity);
        add_rgb(key, lamp.position);
        add_rgb(key, lamp.direction);
        key.number(static_cast<double>(lamp.range)).number(static_cast<double>(lamp.cos_inner));
        key.number(static_cast<double>(lamp.cos_outer));
        if (lamp.radius > 0 || lamp.sin_radius > 0)
            key.text("size").number(static_cast<double>(lamp.radius)).number(static_cast<double>(lamp.sin_radius));
    }
    if (!scene.sky.empty())
        key.text("sky").integer(scene.sky.width).integer(scene.sky.height).number(scene.sky.turn).bytes(bytes_of(scene.sky.nits));
    return key.finish();
}

}  // namespace luxel
