#include "baker/scene/scene_keys.h"

#include "formats/base/bytes.h"

namespace luxel {

namespace {

void add_use(KeyBuilder& key, const Texture& texture, int uv_set, const std::array<float, 6>& transform) {
    key.integer(uv_set).array(std::span<const float>(transform)).integer(texture.width).integer(texture.height);
    key.integer(static_cast<int>(texture.wrap_s)).integer(static_cast<int>(texture.wrap_t)).integer(texture.nearest);
}

void add_rgb(KeyBuilder& key, const Rgb& value) {
    for (int c = 0; c < 3; ++c) key.number(static_cast<double>(value[c]));
}

/// Channels [first, last] of a texture as a material uses it.
void add_channels(KeyBuilder& key, const Texture& texture, std::size_t first, std::size_t last) {
    std::vector<float> values;
    values.reserve(texture.pixels.size() * (last + 1 - first));
    for (const auto& pixel : texture.pixels)
        for (std::size_t c = first; c <= last; ++c) values.push_back(pixel[c]);
    key.bytes(bytes_of(values));
}

/// Does what passes through a material take its base colour?
bool tints(const Material& material) {
    return material.transmission > 0 || (material.alpha_mode == AlphaMode::blend && material.blend_colours);
}

/// Colours of an object's vertices, as rays that pass through it meet them.
void add_vertex_passage(KeyBuilder& key, const Scene& scene, const Object& object) {
    const Material& material = scene.materials[object.material];
    if (!object.is_painted() || !material.is_see_through()) return;
    std::vector<float> values;
    for (std::uint32_t k = 0; k < object.vertex_count; ++k)
        for (std::size_t c = tints(material) ? 0 : 3; c < 4; ++c) values.push_back(scene.colors[object.first_color + k][c]);
    key.text("vertex colours").bytes(bytes_of(values));
}

/// All that see_through.h reads of a material: only alpha of textures, unless their colours tint what passes.
void add_passage(KeyBuilder& key, const Scene& scene, const Material& material) {
    key.integer(static_cast<int>(material.alpha_mode));
    if (!material.is_see_through()) return;
    key.text("see through 1").number(static_cast<double>(material.alpha)).number(static_cast<double>(material.alpha_cutoff));
    const bool is_tinted = tints(material);
    key.integer(is_tinted).integer(material.blend_colours).number(static_cast<double>(material.transmission));
    if (is_tinted) add_rgb(key, material.pane_colour);
    if (material.base_texture != none) {
        const Texture& texture = scene.textures[material.base_texture];
        add_use(key, texture, material.base_uv_set, material.base_transform);
        add_channels(key, texture, is_tinted ? 0 : 3, 3);
    }
    if (material.transmission_texture != none) {
        const Texture& texture = scene.textures[material.transmission_texture];
        add_use(key, texture, material.transmission_uv_set, material.transmission_transform);
        add_channels(key, texture, 0, 0);
    }
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
    std::vector<Key> passage_of_material;
    for (const Material& material : scene.materials) {
        KeyBuilder passage("alpha");
        add_passage(passage, scene, material);
        passage_of_material.push_back(passage.finish());
    }
    for (std::size_t o = 0; o < scene.objects.size(); ++o) {
        const Object& object = scene.objects[o];
        key.integer(static_cast<std::int64_t>(object.path_hash)).integer(static_cast<std::int64_t>(object.content_hash));
        key.integer(object.first_triangle).integer(object.triangle_count).integer(scene.object_has_uv1[o]);
        key.integer(object.double_sided).key(passage_of_material[object.material]);
        add_vertex_passage(key, scene, object);
        if (!object.casts) key.text("casts no shadow");
    }
    return key.finish();
}

Key light_key_of(const Scene& scene) {
    KeyBuilder key("scene light");
    for (const Object& object : scene.objects) key.integer(object.material);
    for (std::size_t o = 0; o < scene.objects.size(); ++o)
        if (!scene.objects[o].receives) key.text("receives no light").integer(static_cast<std::int64_t>(o));
    if (!scene.colors.empty()) {
        key.text("vertex colours").bytes(bytes_of(scene.colors));
        for (const Object& object : scene.objects) key.integer(object.first_color);
    }
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
