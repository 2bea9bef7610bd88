#include "formats/gltf/gltf_out_parts.h"

#include <algorithm>
#include <set>

#include "formats/base/file.h"
#include "formats/gltf/gltf_json.h"
#include "formats/gltf/gltf_node_owners.h"
#include "formats/gltf/gltf_out_meshopt.h"
#include "formats/gltf/gltf_out_uri.h"
#include "formats/gltf/gltf_subset.h"

namespace luxel {

using nlohmann::json;

namespace {

constexpr const char* lights_extension = "KHR_lights_punctual";

/// What a node is besides a place for its mesh.
bool has_camera_or_lamp(const json& node) {
    return node.contains("camera") || json_extension(node, lights_extension, "node");
}

/// ".png" for image/png: the subtype, but for jpeg. Nothing for a type that is none: it comes from the file, and must not
/// lead into another folder.
std::string file_suffix(const std::string& mime_type) {
    constexpr std::string_view begin = "image/", letters = "abcdefghijklmnopqrstuvwxyz0123456789-.";
    if (mime_type == "image/jpeg") return ".jpg";
    if (!mime_type.starts_with(begin) || mime_type.find_first_not_of(letters, begin.size()) != std::string::npos) return {};
    return std::string(".").append(mime_type, begin.size());
}

/// Name and transform, and whether what hangs on it is shown.
json bare_node(const json& node) {
    json bare = json::object();
    for (const char* key : {"name", "matrix", "translation", "rotation", "scale"})
        if (const auto found = node.find(key); found != node.end()) bare[key] = *found;
    if (const json* visibility = json_extension(node, "KHR_node_visibility", "node"))
        bare["extensions"]["KHR_node_visibility"] = *visibility;
    return bare;
}

/// The images of the model that an object needs, itself or by what it names.
class ImageUse {
  public:
    explicit ImageUse(json& root) : root_(root) {}
    void add(GltfKind kind, json& object, std::set<std::uint64_t>& images) {
        visit_references(kind, object, [&](GltfKind named, json& number, ArrayUse) {
            const auto index = number.get<std::uint64_t>();
            const char* array = named == GltfKind::mesh ? "meshes" : named == GltfKind::material ? "materials" : named == GltfKind::texture ? "textures" : nullptr;
            if (named == GltfKind::image) images.insert(index);
            else if (array && index < gltf_count(root_, array)) add(named, root_[array][index], images);
        });
    }

  private:
    json& root_;
};

class PartWriter {
  public:
    PartWriter(const std::filesystem::path& path, OutputModel& model, const ModelFiles& files, const GltfPacking& packing,
               const std::vector<std::uint64_t>& page_images)
        : folder_(path.parent_path()), model_(model), files_(files), packing_(packing), page_images_(page_images),
          owners_(find_node_owners(model.root, *packing.split)) {}

    GltfParts run() {
        try {
            share_pictures();
            for (std::size_t part = 0; part < packing_.split->part_count; ++part)
                out_.parts.push_back(write_part(static_cast<std::int64_t>(part), ".chunk" + std::to_string(part) + ".glb"));
            if (GltfPart common = write_part(common_part, ".common.glb"); !common.file.empty()) out_.common = std::move(common);
            if (gltf_count(model_.root, "scenes") > 1)
                out_.warnings.push_back({"scenes-left-out", model_.document.name, "the files of --split hold one scene, the one that is baked"});
        } catch (...) {
            std::error_code ignored;
            for (const auto& file : out_.files()) std::filesystem::remove(file, ignored);
            throw;
        }
        return std::move(out_);
    }

  private:
    /// Pictures inside the model that more than one of the files needs become files.
    void share_pictures() {
        std::map<std::int64_t, std::set<std::uint64_t>> images_of;
        ImageUse use(model_.root);
        for (const std::uint64_t node : owners_.order) use.add(GltfKind::node, model_.root["nodes"][node], images_of[owners_.owner[node]]);
        std::map<std::uint64_t, int> users;
        for (const auto& [part, images] : images_of)
            for (const std::uint64_t image : images) ++users[image];
        for (const auto& [image, count] : users) {
            if (count < 2 || image >= gltf_count(model_.root, "images")) continue;
            json& item = model_.root["images"][image];
            if (!item.contains("bufferView")) continue;
            const std::string type = json_text(item, "mimeType", "", model_.document.name);
            const auto file = folder_ / files_.free_name(".image" + std::to_string(image) + file_suffix(type));
            publish_file(file, model_.view_bytes(item["bufferView"].get<std::size_t>(), model_.document.name));
            out_.pictures.push_back(file);
            item.erase("bufferView");
            item["uri"] = encode_percent(file.filename().string());
        }
    }

    /// Nothing but an empty file name if no node belongs to it.
    GltfPart write_part(std::int64_t part, const std::string& suffix) {
        GltfPart written;
        for (const std::uint64_t node : owners_.order)
            if (owners_.owner[node] == part && node < packing_.split->part_of_node.size()) written.nodes.push_back(node);
        const std::vector<std::uint64_t> nodes = nodes_of(part);
        if (nodes.empty()) return written;
        OutputModel target = OutputModel::empty(model_.document);
        GltfSubset subset(model_, target);
        subset.name_nodes(nodes);
        for (const std::uint64_t node : nodes) subset.add_node(node_json(part, node, subset));
        if (part == common_part) add_animations(subset);
        std::vector<std::uint64_t> roots;
        for (const std::uint64_t node : nodes)
            if (owners_.parent[node] < 0) roots.push_back(*subset.find_node(node));
        subset.finish(roots, scene_json(part));
        const std::set<std::uint64_t> images = subset.images();
        for (std::size_t page = 0; page < page_images_.size(); ++page)
            if (images.contains(page_images_[page])) written.pages.push_back(static_cast<std::uint32_t>(page));
        if (packing_.meshopt) pack_meshopt(target);
        written.file = folder_ / files_.free_name(suffix);
        ModelFiles file(written.file, target);
        file.take_data_pictures_inside();
        file.write();
        out_.warnings.insert(out_.warnings.end(), target.warnings.begin(), target.warnings.end());
        return written;
    }

    /// Its own nodes and their ancestors, each before what hangs on it.
    std::vector<std::uint64_t> nodes_of(std::int64_t part) const {
        std::vector<bool> is_needed(owners_.owner.size(), false);
        for (const std::uint64_t node : owners_.order)
            is_needed[node] = owners_.owner[node] == part || (part == common_part && has_camera_or_lamp(model_.root["nodes"][node]));
        for (auto node = owners_.order.rbegin(); node != owners_.order.rend(); ++node)
            if (is_needed[*node] && owners_.parent[*node] >= 0) is_needed[static_cast<std::size_t>(owners_.parent[*node])] = true;
        std::vector<std::uint64_t> nodes;
        for (const std::uint64_t node : owners_.order)
            if (is_needed[node]) nodes.push_back(node);
        return nodes;
    }

    json node_json(std::int64_t part, std::uint64_t number, const GltfSubset& subset) {
        const json& source = model_.root["nodes"][number];
        const bool is_own = owners_.owner[number] == part;
        json node = is_own ? source : bare_node(source);
        if (part != common_part) {  // lamps and cameras are in the common file
            node.erase("camera");
            erase_extension(node, lights_extension);
        } else if (!is_own) {
            if (source.contains("camera")) node["camera"] = source["camera"];
            if (const json* lamp = json_extension(source, lights_extension, "node")) node["extensions"][lights_extension] = *lamp;
        }
        erase_extension(node, "MSFT_lod");  // its levels are no part of the scene
        json children = json::array();
        for (const json& child : json_array(source, "children", model_.document.name)) {
            const auto index = child.get<std::uint64_t>();
            if (subset.find_node(index)) children.push_back(index);
        }
        if (is_own && node.contains("skin") && !has_all_joints(node, subset)) {
            node.erase("skin");
            out_.warnings.push_back({"skin-left-out", model_.document.name + ": " + gltf_name(source, "node", static_cast<std::int64_t>(number)),
                                     "its skin has joints outside of the scene, which the files of --split do not hold"});
        }
        node.erase("children");
        if (!children.empty()) node["children"] = std::move(children);
        return node;
    }

    bool has_all_joints(const json& node, const GltfSubset& subset) const {
        const std::int64_t skin = json_index(node, "skin", gltf_count(model_.root, "skins"), model_.document.name);
        if (skin < 0) return false;
        bool has_all = true;
        visit_references(GltfKind::skin, model_.root["skins"][static_cast<std::size_t>(skin)], [&](GltfKind named, json& number, ArrayUse) {
            has_all = has_all && (named != GltfKind::node || subset.find_node(number.get<std::uint64_t>()));
        });
        return has_all;
    }

    void add_animations(GltfSubset& subset) {
        const json& animations = json_array(model_.root, "animations", model_.document.name);
        for (std::size_t k = 0; k < animations.size(); ++k)
            if (!subset.add_animation(animations[k]))
                out_.warnings.push_back({"channels-left-out", model_.document.name + ": " + gltf_name(animations[k], "animation", static_cast<std::int64_t>(k)),
                                         "what it moves is not in the common file of --split, or not in the scene"});
    }

    json scene_json(std::int64_t part) const {
        if (owners_.scene < 0) return json::object();
        const json& scene = model_.root["scenes"][static_cast<std::size_t>(owners_.scene)];
        if (part == common_part) return scene;
        return scene.contains("name") ? json{{"name", scene["name"]}} : json::object();
    }

    std::filesystem::path folder_;
    OutputModel& model_;
    const ModelFiles& files_;
    const GltfPacking& packing_;
    const std::vector<std::uint64_t>& page_images_;
    NodeOwners owners_;
    GltfParts out_;
};

}  // namespace

std::vector<std::filesystem::path> GltfParts::files() const {
    std::vector<std::filesystem::path> all = pictures;
    for (const GltfPart& part : parts)
        if (!part.file.empty()) all.push_back(part.file);
    if (common) all.push_back(common->file);
    return all;
}

GltfParts write_parts(const std::filesystem::path& path, OutputModel& model, const ModelFiles& files, const GltfPacking& packing,
                      const std::vector<std::uint64_t>& page_images) {
    return PartWriter(path, model, files, packing, page_images).run();
}

}  // namespace luxel
