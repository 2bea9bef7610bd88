#include "formats/gltf/gltf_subset.h"

#include <algorithm>
#include <string_view>

#include "formats/gltf/gltf_json.h"
#include "formats/gltf/gltf_out_prune.h"

namespace luxel {

using nlohmann::json;

namespace {

constexpr const char* lights_extension = "KHR_lights_punctual";
constexpr const char* sky_extension = "EXT_lights_image_based";

const char* array_name(GltfKind kind) {
    switch (kind) {
        case GltfKind::accessor: return "accessors";
        case GltfKind::buffer_view: return "bufferViews";
        case GltfKind::mesh: return "meshes";
        case GltfKind::material: return "materials";
        case GltfKind::texture: return "textures";
        case GltfKind::sampler: return "samplers";
        case GltfKind::image: return "images";
        case GltfKind::skin: return "skins";
        case GltfKind::node: return "nodes";
        case GltfKind::camera: return "cameras";
        case GltfKind::light: return "lights";
    }
    return "";
}

/// root.extensions[name].lights
std::uint64_t append_light(json& root, const char* name, json light) {
    json& lights = root["extensions"][name]["lights"];
    if (!lights.is_array()) lights = json::array();
    lights.push_back(std::move(light));
    return lights.size() - 1;
}

/// The object that a number stands for; null if there is none.
json object_of(const json& root, GltfKind kind, std::uint64_t number) {
    const json* owner = &root;
    if (kind == GltfKind::light) owner = json_extension(root, lights_extension, lights_extension);
    if (!owner || number >= gltf_count(*owner, array_name(kind))) return nullptr;
    return (*owner)[array_name(kind)][number];
}

}  // namespace

std::uint64_t GltfSubset::copy(GltfKind kind, std::uint64_t number, ArrayUse use) {
    if (kind == GltfKind::accessor) return copy_array(number, use);
    const auto known = known_.find({kind, number});
    if (known != known_.end()) return known->second;
    std::uint64_t copied = 0;
    if (kind == GltfKind::buffer_view) {
        copied = copy_view(number);
    } else {
        json object = object_of(source_.root, kind, number);
        translate(kind, object);
        copied = kind == GltfKind::light ? append_light(target_.root, lights_extension, std::move(object))
                                         : target_.append(array_name(kind), std::move(object));
    }
    known_.emplace(std::pair{kind, number}, copied);
    return copied;
}

void GltfSubset::translate(GltfKind kind, json& object) {
    drop_unknown(object);
    visit_references(kind, object, [&](GltfKind named, json& number, ArrayUse use) {
        const auto old = number.get<std::uint64_t>();
        if (named != GltfKind::node)
            number = copy(named, old, use);
        else if (const std::uint64_t* node = find_node(old))
            number = *node;
    });
}

std::uint64_t GltfSubset::copy_array(std::uint64_t number, ArrayUse use) {
    const auto known = known_arrays_.find({number, use});
    if (known != known_arrays_.end()) return known->second;
    const std::string where = source_.document.name + ": accessor " + std::to_string(number);
    json item = object_of(source_.root, GltfKind::accessor, number);
    std::uint64_t copied = 0;
    try {
        copied = item.contains("bufferView") || item.contains("sparse")
                     ? arrays_.add(source_.elements(static_cast<std::int64_t>(number), where), use, &item, false)
                     : target_.append("accessors", item);
    } catch (const Error& error) {
        target_.warnings.push_back({"damaged-view", error.where, error.what_text + "; written as zeros"});
        for (const char* key : {"bufferView", "byteOffset", "sparse"}) item.erase(key);
        copied = target_.append("accessors", std::move(item));
    }
    known_arrays_.emplace(std::pair{number, use}, copied);
    return copied;
}

std::uint64_t GltfSubset::copy_view(std::uint64_t number) {
    ByteView bytes;
    const std::string where = source_.document.name + ": bufferView " + std::to_string(number);
    try {
        bytes = source_.view_bytes(number, where);
    } catch (const Error& error) {
        target_.warnings.push_back({"damaged-view", error.where, error.what_text + "; written as one zero byte"});
        return target_.append_view({-1, {}, Bytes(1, 0)});
    }
    return target_.append_view({-1, bytes, {}});
}

/// References that cannot be translated must not stay: they would name something else.
void GltfSubset::drop_unknown(json& object) {
    if (!object.is_structured()) return;
    if (object.is_object() && object.contains("extensions") && object["extensions"].is_object()) {
        std::vector<std::string> names;
        for (const auto& [name, content] : object["extensions"].items())
            if (may_hold_references(name, content)) names.push_back(name);
        for (const std::string& name : names) {
            erase_extension(object, name);
            if (dropped_.insert(name).second)
                target_.warnings.push_back({"extension-left-out", source_.document.name,
                                            name + " is unknown here and may name objects by number; the files of --split do without it"});
        }
    }
    for (auto item = object.begin(); item != object.end(); ++item)
        if (!object.is_object() || item.key() != "extras") drop_unknown(*item);
}

const std::uint64_t* GltfSubset::find(GltfKind kind, std::uint64_t number) const {
    const auto known = known_.find({kind, number});
    return known == known_.end() ? nullptr : &known->second;
}

void GltfSubset::name_nodes(const std::vector<std::uint64_t>& numbers) {
    for (const std::uint64_t number : numbers) known_.emplace(std::pair{GltfKind::node, number}, known_.size());
}

void GltfSubset::add_node(json node) {
    translate(GltfKind::node, node);
    target_.append("nodes", std::move(node));
}

/// A channel's target: a node, or by KHR_animation_pointer a member of some object, "/materials/3/emissiveFactor".
bool GltfSubset::translate_target(json& target) const {
    const json* pointer = json_extension(target, "KHR_animation_pointer", "animation");
    if (!pointer) {
        const auto node = target.find("node");
        const std::uint64_t* found = node != target.end() && node->is_number_unsigned() ? find_node(node->get<std::uint64_t>()) : nullptr;
        if (found) *node = *found;
        return found;
    }
    const std::string path = json_text(*pointer, "pointer", "", "animation");
    for (const GltfKind kind : {GltfKind::node, GltfKind::material, GltfKind::mesh, GltfKind::camera, GltfKind::light}) {
        const std::string begin = kind == GltfKind::light ? std::string("/extensions/") + lights_extension + "/lights/"
                                                          : std::string("/") + array_name(kind) + "/";
        if (!path.starts_with(begin)) continue;
        const std::size_t end = std::min(path.find('/', begin.size()), path.size());
        const std::string digits = path.substr(begin.size(), end - begin.size());
        if (digits.empty() || digits.size() > 9 || digits.find_first_not_of("0123456789") != std::string::npos) return false;
        const std::uint64_t* found = find(kind, std::stoull(digits));
        if (found) target["extensions"]["KHR_animation_pointer"]["pointer"] = begin + std::to_string(*found) + path.substr(end);
        return found;
    }
    return false;
}

bool GltfSubset::add_animation(const json& animation) {
    json copy = animation;
    drop_unknown(copy);
    json channels = json::array(), samplers = json::array();
    std::map<std::uint64_t, std::uint64_t> sampler_numbers;
    const json& all = json_array(animation, "channels", "animation");
    const json& sources = json_array(animation, "samplers", "animation");
    for (const json& channel : all) {
        const std::int64_t sampler = json_index(channel, "sampler", sources.size(), "animation");
        json target = json_object(channel, "target", "animation");
        if (sampler < 0 || !translate_target(target)) continue;
        const auto [known, is_new] = sampler_numbers.emplace(sampler, samplers.size());
        if (is_new) {
            json one = sources[static_cast<std::size_t>(sampler)];
            for (const char* key : {"input", "output"})
                if (one.contains(key) && one[key].is_number_unsigned()) one[key] = copy_array(one[key].get<std::uint64_t>(), ArrayUse::other);
            samplers.push_back(std::move(one));
        }
        json kept = channel;
        kept["sampler"] = known->second;
        kept["target"] = std::move(target);
        channels.push_back(std::move(kept));
    }
    const bool is_whole = channels.size() == all.size();
    if (channels.empty()) return is_whole;
    copy["channels"] = std::move(channels);
    copy["samplers"] = std::move(samplers);
    target_.append("animations", std::move(copy));
    return is_whole;
}

std::set<std::uint64_t> GltfSubset::images() const {
    std::set<std::uint64_t> images;
    for (const auto& [object, copied] : known_)
        if (object.first == GltfKind::image) images.insert(object.second);
    return images;
}

/// The image-based light that a scene names, with its pictures.
void GltfSubset::add_sky(json& scene) {
    const json* sky = json_extension(scene, sky_extension, sky_extension);
    const json* all = json_extension(source_.root, sky_extension, sky_extension);
    if (!sky || !all) return;
    const std::int64_t number = json_index(*sky, "light", gltf_count(*all, "lights"), sky_extension);
    if (number < 0) return;
    json light = (*all)["lights"][static_cast<std::size_t>(number)];
    for (json& level : light["specularImages"])
        for (json& image : level)
            if (image.is_number_unsigned()) image = copy(GltfKind::image, image.get<std::uint64_t>());
    scene["extensions"][sky_extension]["light"] = append_light(target_.root, sky_extension, std::move(light));
}

void GltfSubset::finish(const std::vector<std::uint64_t>& roots, const json& scene) {
    json copy = scene.is_object() ? scene : json::object();
    json sky = {{"extensions", json::object()}};
    if (const json* found = json_extension(copy, sky_extension, sky_extension)) sky["extensions"][sky_extension] = *found;
    erase_extension(copy, sky_extension);
    drop_unknown(copy);
    add_sky(sky);
    if (sky["extensions"].contains(sky_extension)) copy["extensions"][sky_extension] = sky["extensions"][sky_extension];
    copy["nodes"] = roots;
    target_.root["scenes"] = json::array({std::move(copy)});
    target_.root["scene"] = 0;
    target_.root["asset"] = source_.root["asset"];
    copy_extension_lists();
}

/// Names of the lists that something in the new model bears, or that no object ever bears.
void GltfSubset::copy_extension_lists() {
    for (const char* name : {"KHR_materials_variants", "KHR_xmp_json_ld"})
        if (const json* content = json_extension(source_.root, name, name); content && has_extension(target_.root, name))
            target_.root["extensions"][name] = *content;
    for (const char* list : {"extensionsUsed", "extensionsRequired"})
        for (const json& name : json_array(source_.root, list, list)) {
            if (!name.is_string()) continue;
            const auto text = name.get<std::string>();
            const bool is_borne = has_extension(target_.root, text) || (text == "KHR_mesh_quantization" && target_.root.contains("meshes"));
            if (!is_borne) continue;
            if (list == std::string_view("extensionsUsed")) use_extension(target_.root, text);
            else require_extension(target_.root, text);
        }
}

}  // namespace luxel
