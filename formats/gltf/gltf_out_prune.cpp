#include "formats/gltf/gltf_out_prune.h"

#include <array>
#include <map>
#include <string_view>

#include "formats/gltf/gltf_json.h"

namespace luxel {

using nlohmann::json;

namespace {

constexpr std::uint64_t removed = ~std::uint64_t{0};

/// Member `key` if it is a whole number; nullptr otherwise.
json* number_member(json& object, const char* key) {
    if (!object.is_object()) return nullptr;
    const auto found = object.find(key);
    return found != object.end() && found->is_number_unsigned() ? &*found : nullptr;
}

json* member(json& object, const char* key) {
    if (!object.is_object()) return nullptr;
    const auto found = object.find(key);
    return found == object.end() ? nullptr : &*found;
}

template <class Visit>
void for_items(json* items, const Visit& visit) {
    if (items && items->is_structured())
        for (json& item : *items) visit(item);
}

json* extension_member(json& object, const char* name) {
    json* extensions = member(object, "extensions");
    return extensions ? member(*extensions, name) : nullptr;
}

template <class Visit>
void for_numbers(json* items, ArrayUse use, const Visit& visit) {
    for_items(items, [&](json& value) {
        if (value.is_number_unsigned()) visit(value, use);
    });
}

/// Calls accessor(number, use) and view(number) for every reference in a mesh.
template <class Accessor, class View>
void visit_mesh(json& mesh, const Accessor& accessor, const View& view) {
    for_items(member(mesh, "primitives"), [&](json& primitive) {
        for_numbers(member(primitive, "attributes"), ArrayUse::vertices, accessor);
        if (json* indices = number_member(primitive, "indices")) accessor(*indices, ArrayUse::indices);
        for_items(member(primitive, "targets"),
                  [&](json& target) { for_numbers(&target, ArrayUse::vertices, accessor); });
        if (json* draco = extension_member(primitive, "KHR_draco_mesh_compression"))
            if (json* number = number_member(*draco, "bufferView")) view(*number);
    });
}

template <class Accessor, class View>
void visit_model(json& root, const Accessor& accessor, const View& view) {
    for_items(member(root, "meshes"), [&](json& mesh) { visit_mesh(mesh, accessor, view); });
    for_items(member(root, "skins"), [&](json& skin) {
        if (json* number = number_member(skin, "inverseBindMatrices")) accessor(*number, ArrayUse::other);
    });
    for_items(member(root, "animations"), [&](json& animation) {
        for_items(member(animation, "samplers"), [&](json& sampler) {
            for (const char* key : {"input", "output"})
                if (json* number = number_member(sampler, key)) accessor(*number, ArrayUse::other);
        });
    });
    for_items(member(root, "nodes"), [&](json& node) {
        if (json* copies = extension_member(node, "EXT_mesh_gpu_instancing"))
            for_numbers(member(*copies, "attributes"), ArrayUse::other, accessor);
    });
    for_items(member(root, "images"), [&](json& image) {
        if (json* number = number_member(image, "bufferView")) view(*number);
    });
}

template <class View>
void visit_accessor(json& accessor, const View& view) {
    if (json* number = number_member(accessor, "bufferView")) view(*number);
    if (json* sparse = member(accessor, "sparse"))
        for (const char* part : {"indices", "values"})
            if (json* place = member(*sparse, part))
                if (json* number = number_member(*place, "bufferView")) view(*number);
}

/// Extensions whose numbers are known: none of them but the visited ones names an accessor or a view.
bool is_known(std::string_view name) {
    constexpr std::array known{"KHR_draco_mesh_compression",
                               "EXT_meshopt_compression",
                               "KHR_meshopt_compression",
                               "EXT_mesh_gpu_instancing",
                               "KHR_lights_punctual",
                               "KHR_texture_transform",
                               "KHR_texture_basisu",
                               "EXT_texture_webp",
                               "EXT_texture_avif",
                               "MSFT_texture_dds",
                               "KHR_mesh_quantization",
                               "KHR_xmp_json_ld",
                               "KHR_animation_pointer",
                               "KHR_node_visibility",
                               "MSFT_lod",
                               "MOZ_lightmap",
                               "MX_lightmap",
                               "MOZ_texture_rgbe",
                               "EXT_texture_exr",
                               "MOZ_hubs_components"};
    for (const char* one : known)
        if (name == one) return true;
    return name.starts_with("KHR_materials_");
}

bool holds_whole_number(const json& value) {
    if (value.is_number_integer()) return true;
    if (value.is_structured())
        for (const json& item : value)
            if (holds_whole_number(item)) return true;
    return false;
}

}  // namespace

bool may_hold_references(std::string_view extension, const json& content) {
    return !is_known(extension) && holds_whole_number(content);
}

namespace {

bool may_hold_unknown_references(const json& tree) {
    if (!tree.is_structured()) return false;
    if (tree.is_object()) {
        for (const auto& [key, value] : tree.items()) {
            if (key == "extras") continue;
            if (key == "extensions" && value.is_object())
                for (const auto& [name, content] : value.items())
                    if (may_hold_references(name, content)) return true;
            if (may_hold_unknown_references(value)) return true;
        }
        return false;
    }
    for (const json& item : tree)
        if (may_hold_unknown_references(item)) return true;
    return false;
}

/// Erases the items of a top-level array that `keep` does not want; returns old number -> new number.
template <class Keep>
std::vector<std::uint64_t> erase_items(json& root, const char* array, const Keep& keep) {
    std::vector<std::uint64_t> renumbered(gltf_count(root, array), removed);
    json kept = json::array();
    for (std::uint64_t index = 0; index < renumbered.size(); ++index) {
        if (!keep(index)) continue;
        renumbered[index] = kept.size();
        kept.push_back(std::move(root[array][index]));
    }
    if (kept.empty())
        root.erase(array);
    else
        root[array] = std::move(kept);
    return renumbered;
}

void renumber(json& number, const std::vector<std::uint64_t>& renumbered) {
    const auto old = number.get<std::uint64_t>();
    if (old < renumbered.size() && renumbered[old] != removed) number = renumbered[old];
}

/// Accessors that stay although a part of their view goes: a view of their own with just their elements.
void repack(OutputModel& model, const std::map<std::uint64_t, ArrayUse>& used,
            const std::set<std::uint64_t>& shrinking_views) {
    const std::size_t accessor_count = gltf_count(model.root, "accessors");
    ArrayStore arrays(model);
    for (const auto& [index, use] : used) {
        if (index >= gltf_count(model.document.json, "accessors")) continue;  // written by this run
        const json* source = &model.document.json["accessors"][index];
        const auto view = source->find("bufferView");
        if (view == source->end() || !view->is_number_unsigned() ||
            !shrinking_views.contains(view->get<std::uint64_t>()))
            continue;
        const std::string where = model.document.name + ": accessor " + std::to_string(index);
        try {
            const std::uint64_t copy =
                arrays.add(read_elements(model.document, static_cast<std::int64_t>(index), where), use, source, false);
            // The copy takes the old number, so no reference has to change.
            model.root["accessors"][index] = model.root["accessors"][copy];
        } catch (const Error&) {
            continue;  // a damaged array that no triangle uses keeps the whole view, as it is
        }
    }
    json& accessors = model.root["accessors"];
    accessors.erase(accessors.begin() + static_cast<std::ptrdiff_t>(accessor_count), accessors.end());
}

}  // namespace

void collect_references(const json& mesh, ArrayReferences& found) {
    json copy = mesh;  // the visitor is shared with the renumbering, which writes
    visit_mesh(
        copy, [&](const json& number, ArrayUse) { found.accessors.insert(number.get<std::uint64_t>()); },
        [&](const json& number) { found.views.insert(number.get<std::uint64_t>()); });
}

void prune_arrays(OutputModel& model, const ArrayReferences& replaced) {
    if (may_hold_unknown_references(model.root)) {
        model.warnings.push_back({"unused-arrays-kept", model.document.name,
                                  "arrays of the input that are no longer used stay in the file, because an unknown "
                                  "extension might refer to them"});
        return;
    }
    json& root = model.root;
    std::map<std::uint64_t, ArrayUse> used;
    std::set<std::uint64_t> used_views;
    const auto mark_view = [&](const json& number) { used_views.insert(number.get<std::uint64_t>()); };
    visit_model(
        root, [&](const json& number, ArrayUse use) { used.emplace(number.get<std::uint64_t>(), use); }, mark_view);
    const auto keep_accessor = [&](std::uint64_t index) {
        return used.contains(index) || !replaced.accessors.contains(index);
    };

    std::set<std::uint64_t> released_views = replaced.views;
    for (const std::uint64_t index : replaced.accessors)
        if (!keep_accessor(index) && index < gltf_count(root, "accessors"))
            visit_accessor(root["accessors"][index],
                           [&](const json& number) { released_views.insert(number.get<std::uint64_t>()); });
    if (!released_views.empty()) repack(model, used, released_views);

    const auto accessor_numbers = erase_items(root, "accessors", keep_accessor);
    for_items(member(root, "accessors"), [&](json& accessor) { visit_accessor(accessor, mark_view); });
    const auto view_numbers = erase_items(root, "bufferViews", [&](std::uint64_t index) {
        return used_views.contains(index) || !released_views.contains(index);
    });
    std::vector<OutputView> views;
    for (std::uint64_t index = 0; index < view_numbers.size(); ++index)
        if (view_numbers[index] != removed) views.push_back(std::move(model.views[index]));
    model.views = std::move(views);

    const auto renumber_view = [&](json& number) { renumber(number, view_numbers); };
    visit_model(
        root, [&](json& number, ArrayUse) { renumber(number, accessor_numbers); }, renumber_view);
    for_items(member(root, "accessors"), [&](json& accessor) { visit_accessor(accessor, renumber_view); });
}

}  // namespace luxel
