#include "formats/gltf/gltf_out_material.h"

#include "formats/gltf/gltf_out_nodes.h"
#include "formats/gltf/gltf_out_unlit.h"

namespace luxel {

using nlohmann::json;

namespace {

constexpr const char* lightmap_extension = "MOZ_lightmap";

/// Calls visit(value) for every "texCoord" in the object and below.
template <class Json, class Visit>
void for_uv_sets(Json& value, const Visit& visit) {
    if (value.is_array()) {
        for (auto& item : value) for_uv_sets(item, visit);
    } else if (value.is_object()) {
        for (auto item = value.begin(); item != value.end(); ++item) {
            if (item.key() == "texCoord" && item.value().is_number_unsigned())
                visit(item.value());
            else if (item.key() != "extras" && item.key() != lightmap_extension)
                for_uv_sets(item.value(), visit);
        }
    }
}

}  // namespace

bool uses_uv_set(const json& object, std::uint64_t set) {
    bool found = false;
    for_uv_sets(object, [&](const json& value) { found = found || value == set; });
    return found;
}

void change_uv_set(json& object, std::uint64_t from, std::uint64_t to) {
    for_uv_sets(object, [&](json& value) {
        if (value == from) value = to;
    });
}

bool has_texture(const json& material) {
    if (!material.is_object()) return false;
    for (const auto& [key, value] : material.items()) {
        if (key == "extras" || key == lightmap_extension) continue;
        if (key.ends_with("Texture") || has_texture(value)) return true;
    }
    return false;
}

LightmapMaterials::LightmapMaterials(OutputModel& model, const GltfLightmaps& lightmaps,
                                     const std::vector<std::uint64_t>& images)
    : model_(model), lightmaps_(lightmaps) {
    if (images.empty()) return;
    // Clamped, and without mipmaps: a coarser level would mix neighbouring charts.
    constexpr int linear = 9729, clamp_to_edge = 33071;
    const std::uint64_t sampler = model.append(
        "samplers", {{"magFilter", linear}, {"minFilter", linear}, {"wrapS", clamp_to_edge}, {"wrapT", clamp_to_edge}});
    const std::string& extension = lightmaps.meaning.texture_extension;
    for (std::size_t page = 0; page < images.size(); ++page) {
        json texture = {{"name", lightmaps.pages[page].name}, {"sampler", sampler}};
        (extension.empty() ? texture : texture["extensions"][extension])["source"] = images[page];
        textures_.push_back(model.append("textures", std::move(texture)));
    }
    if (!extension.empty()) use_extension(model.root, extension);
}

const json& LightmapMaterials::source(std::int64_t material) const {
    static const json default_material = json::object();
    const auto materials = model_.document.json.find("materials");
    if (material < 0 || materials == model_.document.json.end()) return default_material;
    return (*materials)[static_cast<std::size_t>(material)];
}

void LightmapMaterials::set_place(json& texture_use, const LayoutPlace& place) {
    if (place.is_identity()) return;
    texture_use["extensions"]["KHR_texture_transform"] = {{"offset", {place.offset.x, place.offset.y}}, {"scale", {place.scale.x, place.scale.y}}};
    use_extension(model_.root, "KHR_texture_transform");
}

json LightmapMaterials::make_unlit(std::int64_t material, std::uint32_t page, const LayoutPlace& place) {
    json made = unlit_material(source(material), textures_[page]);
    set_place(made["pbrMetallicRoughness"]["baseColorTexture"], place);
    use_extension(model_.root, "KHR_materials_unlit");
    return made;
}

json LightmapMaterials::make_lit(std::int64_t material, std::uint32_t page, const LayoutPlace& place, std::uint64_t moved_uv_set) {
    json copy = source(material);
    if (moved_uv_set) change_uv_set(copy, 1, moved_uv_set);
    const LightmapMeaning& meaning = lightmaps_.meaning;
    const bool is_unlit = copy.contains("extensions") && copy["extensions"].contains("KHR_materials_unlit");
    const double scale = is_unlit ? meaning.unlit_scale : meaning.lit_scale;
    copy["extensions"][lightmap_extension] = {{"index", textures_[page]},
                                              {"texCoord", 1},
                                              {"intensity", lightmaps_.pages[page].intensity * scale},
                                              {"extras", lightmap_extras(meaning, scale)}};
    set_place(copy["extensions"][lightmap_extension], place);
    use_extension(model_.root, lightmap_extension);
    return copy;
}

std::uint64_t LightmapMaterials::clone(std::int64_t material, std::uint32_t page, const LayoutPlace& place, std::uint64_t moved_uv_set) {
    const CloneKey key{material, page, {place.scale.x, place.scale.y, place.offset.x, place.offset.y}, moved_uv_set};
    if (const auto known = clones_.find(key); known != clones_.end()) return known->second;
    const std::uint64_t index =
        model_.append("materials", lightmaps_.is_unlit ? make_unlit(material, page, place) : make_lit(material, page, place, moved_uv_set));
    clones_.emplace(key, index);
    return index;
}

std::int64_t LightmapMaterials::without_lightmap(std::int64_t material, std::uint64_t moved_uv_set) {
    const auto [known, is_new] = plain_clones_.emplace(std::pair(material, moved_uv_set), material);
    if (!is_new || material < 0) return known->second;
    json copy = source(material);
    if (moved_uv_set) change_uv_set(copy, 1, moved_uv_set);
    erase_extension(copy, lightmap_extension);
    if (copy != source(material)) known->second = static_cast<std::int64_t>(model_.append("materials", std::move(copy)));
    return known->second;
}

}  // namespace luxel
