#include "formats/gltf/gltf_out_unlit.h"

#include <algorithm>
#include <array>

#include "formats/gltf/gltf_json.h"

namespace luxel {

using nlohmann::json;

namespace {

constexpr const char* variants_extension = "KHR_materials_variants";

/// Calls visit(item) for the items of a member that is a list; what nobody has read so far may be anything.
template <class Visit>
void for_list(json& parent, const char* key, const Visit& visit) {
    if (const auto list = parent.find(key); list != parent.end() && list->is_array())
        for (json& item : *list) visit(item);
}

/// Calls visit(number) with every material of every primitive, those of variants too.
template <class Visit>
void for_materials(json& root, const Visit& visit) {
    const auto visit_owner = [&](json& owner) {
        if (const auto material = owner.find("material"); material != owner.end() && material->is_number_unsigned()) visit(*material);
    };
    for_list(root, "meshes", [&](json& mesh) {
        for_list(mesh, "primitives", [&](json& primitive) {
            visit_owner(primitive);
            const auto extensions = primitive.find("extensions");
            if (extensions == primitive.end() || !extensions->is_object() || !extensions->contains(variants_extension)) return;
            for_list((*extensions)[variants_extension], "mappings", visit_owner);
        });
    });
}

/// Is there an extension of the object itself beside those that are known to name neither materials nor textures?
bool has_unknown_extension(const json& object) {
    const auto extensions = object.find("extensions");
    if (extensions == object.end() || !extensions->is_object()) return false;
    return std::ranges::any_of(extensions->items(), [](const auto& item) {
        return item.key() != "KHR_lights_punctual" && item.key() != variants_extension && item.key() != "EXT_mesh_gpu_instancing";
    });
}

bool may_be_named_elsewhere(const json& root) {
    if (has_unknown_extension(root)) return true;
    for (const char* array : {"nodes", "scenes"})
        if (const auto items = root.find(array); items != root.end() && std::ranges::any_of(*items, has_unknown_extension)) return true;
    const auto animations = root.find("animations");
    return animations != root.end() && has_extension(*animations, "KHR_animation_pointer");
}

/// Without the first `count` items; a list that becomes empty goes.
void drop_first(json& root, const char* array, std::size_t count) {
    if (!count) return;
    json& items = root[array];
    items.erase(items.begin(), items.begin() + static_cast<std::ptrdiff_t>(count));
    if (items.empty()) root.erase(array);
}

/// What only materials and textures of the input used. Others may matter without an object of theirs, as KHR_mesh_quantization does.
void drop_unused_names(json& root) {
    std::vector<std::string> unused;
    for_list(root, "extensionsUsed", [&](const json& name) {
        if (!name.is_string()) return;
        const auto text = name.get<std::string>();
        const bool is_of_looks = std::ranges::any_of(std::array{"KHR_materials_", "KHR_texture_", "EXT_texture_", "MSFT_texture_", "MOZ_"},
                                                     [&](const char* begin) { return text.starts_with(begin); });
        if (is_of_looks && !has_extension(root, text)) unused.push_back(text);
    });
    for (const std::string& name : unused) drop_extension(root, name);
}

void lower(json& number, std::size_t by) { number = number.get<std::uint64_t>() - by; }

}  // namespace

void drop_input_materials(OutputModel& model, ArrayReferences& replaced) {
    json& root = model.root;
    const auto count = [&](const char* array) { return gltf_count(model.document.json, array); };
    bool is_shown = false;
    for_materials(root, [&](const json& material) { is_shown = is_shown || material.get<std::uint64_t>() < count("materials"); });
    if (is_shown || may_be_named_elsewhere(root)) return;
    for_list(root, "images", [&](const json& image) {
        if (const auto view = image.find("bufferView"); view != image.end() && view->is_number_unsigned()) replaced.views.insert(view->get<std::uint64_t>());
    });
    for (const char* array : {"materials", "textures", "samplers", "images"}) drop_first(root, array, count(array));
    for_materials(root, [&](json& material) { lower(material, count("materials")); });
    for_list(root, "materials", [&](json& material) { lower(material["pbrMetallicRoughness"]["baseColorTexture"]["index"], count("textures")); });
    for_list(root, "textures", [&](json& texture) {
        lower(texture["source"], count("images"));
        lower(texture["sampler"], count("samplers"));
    });
    drop_unused_names(root);
}

json unlit_material(const json& source, std::uint64_t texture) {
    json material = json::object();
    for (const char* key : {"name", "extras", "doubleSided", "alphaMode"})
        if (source.contains(key)) material[key] = source[key];
    // Viewers that do not know the extension show a rough dielectric.
    material["pbrMetallicRoughness"] = {{"baseColorTexture", {{"index", texture}, {"texCoord", 1}}}, {"metallicFactor", 0.0}, {"roughnessFactor", 1.0}};
    material["extensions"]["KHR_materials_unlit"] = json::object();
    const std::string where = "material";
    if (const json* pane = json_extension(source, "KHR_materials_transmission", where)) {
        const auto factor = pane->find("transmissionFactor");
        const double passes = factor != pane->end() && factor->is_number() ? std::clamp(factor->get<double>(), 0.0, 1.0) : 0.0;
        if (passes > 0) {
            material["alphaMode"] = "BLEND";
            material["pbrMetallicRoughness"]["baseColorFactor"] = {1.0, 1.0, 1.0, 1.0 - passes};
        }
    }
    return material;
}

}  // namespace luxel
