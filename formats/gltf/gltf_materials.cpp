#include "formats/gltf/gltf_materials.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "formats/gltf/gltf_json.h"

namespace luxel {

using nlohmann::json;

namespace {

/// The affine map of KHR_texture_transform. Its text says counter-clockwise in an image whose v points down, and its
/// example (offset 0 1, rotation pi/2, scale 0.5 shows the lower left quadrant) agrees with this sign of the sines, as
/// do the Khronos viewer and three.js; the GLSL in the text, read column by column, would turn the other way.
std::array<double, 6> texture_transform(const json& extension, const std::string& where) {
    std::array<double, 2> offset{0, 0}, scale{1, 1};
    json_numbers(extension, "offset", offset, where);
    json_numbers(extension, "scale", scale, where);
    const double angle = json_number(extension, "rotation", 0, where);
    const double c = std::cos(angle), s = std::sin(angle);
    return {c * scale[0], s * scale[1], offset[0], -s * scale[0], c * scale[1], offset[1]};
}

TextureUse read_texture_use(const json& parent, const char* key, std::size_t texture_count, const std::string& where) {
    TextureUse use;
    if (!parent.contains(key)) return use;
    const json& info = json_object(parent, key, where);
    const std::string here = where + ": " + key;
    const std::int64_t texture = json_index(info, "index", texture_count, here);
    if (texture < 0) bad_gltf(here, "\"index\" is missing");
    use.texture = static_cast<int>(texture);
    std::uint64_t uv_set = json_size(info, "texCoord", 0, here);
    if (const json* extension = json_extension(info, "KHR_texture_transform", here)) {
        use.transform = texture_transform(*extension, here);
        uv_set = json_size(*extension, "texCoord", uv_set, here);
    }
    use.uv_set = static_cast<int>(std::min<std::uint64_t>(uv_set, 1000));
    return use;
}

void read_base_color(const json& item, std::size_t texture_count, MaterialRecord& material, const std::string& where) {
    const json& pbr = json_object(item, "pbrMetallicRoughness", where);
    json_numbers(pbr, "baseColorFactor", material.base_color, where);
    material.base_color_texture = read_texture_use(pbr, "baseColorTexture", texture_count, where);
    if (const json* glossy = json_extension(item, "KHR_materials_pbrSpecularGlossiness", where)) {
        material.base_color = {1, 1, 1, 1};
        json_numbers(*glossy, "diffuseFactor", material.base_color, where);
        material.base_color_texture = read_texture_use(*glossy, "diffuseTexture", texture_count, where);
    } else if (!json_extension(item, "KHR_materials_unlit", where)) {
        material.has_metallic_texture = pbr.contains("metallicRoughnessTexture");
        material.metallic = material.has_metallic_texture ? 0 : json_number(pbr, "metallicFactor", 1, where);
    }
}

void read_emission(const json& item, std::size_t texture_count, MaterialRecord& material, const std::string& where) {
    json_numbers(item, "emissiveFactor", material.emission, where);
    material.emissive_texture = read_texture_use(item, "emissiveTexture", texture_count, where);
    if (const json* extension = json_extension(item, "KHR_materials_emissive_strength", where)) {
        const double strength = json_number(*extension, "emissiveStrength", 1, where);
        for (double& channel : material.emission) channel *= strength;
    }
}

void read_alpha(const json& item, MaterialRecord& material, std::vector<Warning>& warnings, const std::string& where) {
    const std::string mode = json_text(item, "alphaMode", "OPAQUE", where);
    if (mode == "MASK") material.alpha_mode = AlphaMode::mask;
    else if (mode == "BLEND") material.alpha_mode = AlphaMode::blend;
    else if (mode != "OPAQUE")
        warnings.push_back({"alpha-mode", where, "alphaMode \"" + mode + "\" is unknown and counts as OPAQUE"});
    material.alpha_cutoff = json_number(item, "alphaCutoff", 0.5, where);
}

MaterialRecord read_material(const json& item, std::size_t texture_count, std::vector<Warning>& warnings,
                             const std::string& where) {
    MaterialRecord material;
    material.name = json_text(item, "name", "", where);
    read_base_color(item, texture_count, material, where);
    read_emission(item, texture_count, material, where);
    read_alpha(item, material, warnings, where);
    material.double_sided = json_bool(item, "doubleSided", false, where);
    if (const json* extension = json_extension(item, "KHR_materials_transmission", where)) {
        material.transmission = json_number(*extension, "transmissionFactor", 0, where);
        if (material.transmission != 0)
            material.transmission_texture = read_texture_use(*extension, "transmissionTexture", texture_count, where);
    }
    material.unlit = json_extension(item, "KHR_materials_unlit", where) != nullptr;
    return material;
}

/// One note per extension, however many materials use it.
void note_extensions(const json& item, std::set<std::string>& noted, std::vector<Warning>& warnings,
                     const std::string& where) {
    static const std::set<std::string> read{"KHR_materials_emissive_strength", "KHR_materials_pbrSpecularGlossiness",
                                            "KHR_materials_transmission", "MOZ_lightmap"};
    for (const auto& [name, value] : json_object(item, "extensions", where).items()) {
        if (read.contains(name) || !noted.insert(name).second) continue;
        const std::string what = name == "KHR_materials_unlit"
                                     ? ": unlit surfaces reflect like others, and emit only what the file says"
                                     : " is kept in the file, but ignored: surfaces reflect diffusely";
        warnings.push_back({"material-extension", where, name + what});
    }
}

WrapMode wrap_mode(const json& sampler, const char* key, const std::string& where) {
    switch (json_size(sampler, key, 10497, where)) {
        case 33071: return WrapMode::clamp;
        case 33648: return WrapMode::mirror;
        default: return WrapMode::repeat;
    }
}

TextureRecord read_texture(const GltfDocument& document, std::int64_t index, std::vector<Warning>& warnings) {
    const json& item = gltf_item(document.json, "textures", index, document.name);
    const std::string where = document.name + ": " + gltf_name(item, "texture", index);
    const std::size_t image_count = gltf_count(document.json, "images");
    TextureRecord texture;
    std::int64_t image = json_index(item, "source", image_count, where);
    if (const json* webp = json_extension(item, "EXT_texture_webp", where)) {
        const std::int64_t better = json_index(*webp, "source", image_count, where);
        if (better >= 0) texture.other = static_cast<int>(image), image = better;
    }
    texture.image = static_cast<int>(image);
    if (image < 0)
        warnings.push_back({"texture-format", where,
                            json_extension(item, "KHR_texture_basisu", where)
                                ? "KHR_texture_basisu without a PNG or JPEG beside it cannot be decoded: the texture counts as white"
                                : "has no image: the texture counts as white"});
    const std::int64_t sampler = json_index(item, "sampler", gltf_count(document.json, "samplers"), where);
    if (sampler >= 0) {
        const json& how = gltf_item(document.json, "samplers", sampler, where);
        texture.wrap_s = wrap_mode(how, "wrapS", where);
        texture.wrap_t = wrap_mode(how, "wrapT", where);
        texture.nearest = json_size(how, "magFilter", 9729, where) == 9728;
    }
    return texture;
}

ImageRecord describe_image(const GltfDocument& document, std::int64_t index) {
    const json& item = gltf_item(document.json, "images", index, document.name);
    const std::string where = document.name + ": image " + std::to_string(index);
    ImageRecord image;
    const std::string uri = json_text(item, "uri", "", where);
    image.name = json_text(item, "name", "", where);
    if (image.name.empty()) image.name = uri.empty() || uri.rfind("data:", 0) == 0 ? "image " + std::to_string(index) : uri;
    image.mime_type = json_text(item, "mimeType", "", where);
    return image;
}

/// A picture that cannot be had is no reason to stop: the material's factor stands for it.
void load_image(const GltfDocument& document, std::int64_t index, bool external_images, ImageRecord& image,
                const char* instead, std::vector<Warning>& warnings) {
    const json& item = gltf_item(document.json, "images", index, document.name);
    const std::string where = document.name + ": image \"" + image.name + "\"";
    try {
        if (item.contains("bufferView")) {
            const ByteView view =
                document.view(static_cast<std::int64_t>(json_size_required(item, "bufferView", where)), where);
            image.bytes.assign(view.begin(), view.end());
            return;
        }
        const std::string uri = json_text(item, "uri", "", where);
        if (uri.empty()) bad_gltf(where, "has neither a uri nor a bufferView");
        const bool embedded = uri.rfind("data:", 0) == 0;
        if (!embedded && !external_images) return;
        std::string mime_type;
        image.bytes = read_uri(document, uri, where, &mime_type);
        if (image.bytes.empty()) bad_gltf(where, "is empty");
        if (image.mime_type.empty()) image.mime_type = mime_type;
    } catch (const Error& problem) {
        warnings.push_back({"image-missing", problem.where, problem.what_text + instead});
        image.bytes.clear();
    }
}

}  // namespace

ImageRecord read_image(const GltfDocument& document, std::int64_t index, bool external_images, std::vector<Warning>& warnings) {
    ImageRecord image = describe_image(document, index);
    load_image(document, index, external_images, image, "", warnings);
    return image;
}

void read_materials(const GltfDocument& document, bool external_images, SceneRecord& record) {
    const std::size_t texture_count = gltf_count(document.json, "textures");
    std::set<std::string> noted;
    std::set<int> used_textures;
    for (std::size_t m = 0; m < gltf_count(document.json, "materials"); ++m) {
        const auto index = static_cast<std::int64_t>(m);
        const json& item = gltf_item(document.json, "materials", index, document.name);
        const std::string where = document.name + ": " + gltf_name(item, "material", index);
        record.materials.push_back(read_material(item, texture_count, record.warnings, where));
        note_extensions(item, noted, record.warnings, where);
        used_textures.insert(record.materials.back().base_color_texture.texture);
        used_textures.insert(record.materials.back().emissive_texture.texture);
        used_textures.insert(record.materials.back().transmission_texture.texture);
    }
    std::set<int> used_images, replaceable;
    for (std::size_t t = 0; t < texture_count; ++t) {
        std::vector<Warning> unused;
        const bool is_used = used_textures.contains(static_cast<int>(t));
        record.textures.push_back(read_texture(document, static_cast<std::int64_t>(t), is_used ? record.warnings : unused));
        const TextureRecord& texture = record.textures.back();
        if (is_used) used_images.insert({texture.image, texture.other});
        if (texture.other >= 0) replaceable.insert(texture.image);
    }
    for (std::size_t i = 0; i < gltf_count(document.json, "images"); ++i) {
        record.images.push_back(describe_image(document, static_cast<std::int64_t>(i)));
        if (used_images.contains(static_cast<int>(i)))
            load_image(document, static_cast<std::int64_t>(i), external_images, record.images.back(),
                       replaceable.contains(static_cast<int>(i)) ? "; the picture beside it is taken" : "; the texture counts as white",
                       record.warnings);
    }
}

}  // namespace luxel
