#include "formats/gltf/gltf_references.h"

#include "formats/gltf/gltf_json.h"

namespace luxel {

using nlohmann::json;

namespace {

json* member(json& object, const char* key) {
    if (!object.is_object()) return nullptr;
    const auto found = object.find(key);
    return found == object.end() ? nullptr : &*found;
}

json* extension(json& object, const char* name) {
    json* extensions = member(object, "extensions");
    return extensions ? member(*extensions, name) : nullptr;
}

class Visitor {
  public:
    explicit Visitor(const ReferenceVisitor& visit) : visit_(visit) {}

    void of(GltfKind kind, json& object) {
        switch (kind) {
            case GltfKind::accessor: return;  // copied as arrays, not as references
            case GltfKind::mesh: return mesh(object);
            case GltfKind::material: return textures(object);
            case GltfKind::texture: return texture(object);
            case GltfKind::image: return number(member(object, "bufferView"), GltfKind::buffer_view);
            case GltfKind::skin: return skin(object);
            case GltfKind::node: return node(object);
            case GltfKind::buffer_view: case GltfKind::sampler: case GltfKind::camera: case GltfKind::light: return;
        }
    }

  private:
    void number(json* value, GltfKind kind, ArrayUse use = ArrayUse::other) {
        if (value && value->is_number_unsigned()) visit_(kind, *value, use);
    }
    void numbers(json* values, GltfKind kind, ArrayUse use = ArrayUse::other) {
        if (values && values->is_structured())
            for (json& value : *values) number(&value, kind, use);
    }

    void mesh(json& object) {
        json* primitives = member(object, "primitives");
        if (!primitives || !primitives->is_array()) return;
        for (json& primitive : *primitives) {
            numbers(member(primitive, "attributes"), GltfKind::accessor, ArrayUse::vertices);
            number(member(primitive, "indices"), GltfKind::accessor, ArrayUse::indices);
            if (json* targets = member(primitive, "targets"); targets && targets->is_array())
                for (json& target : *targets) numbers(&target, GltfKind::accessor, ArrayUse::vertices);
            if (json* draco = extension(primitive, "KHR_draco_mesh_compression"))
                number(member(*draco, "bufferView"), GltfKind::buffer_view);
            number(member(primitive, "material"), GltfKind::material);
            json* variants = extension(primitive, "KHR_materials_variants");
            if (json* mappings = variants ? member(*variants, "mappings") : nullptr; mappings && mappings->is_array())
                for (json& mapping : *mappings) number(member(mapping, "material"), GltfKind::material);
        }
    }

    /// Every `index` of an object under a name that ends in "Texture", and MOZ_lightmap's.
    void textures(json& object) {
        if (!object.is_object()) return;
        for (auto item = object.begin(); item != object.end(); ++item) {
            if (item.key() == "extras") continue;
            if (item.key().ends_with("Texture") || item.key() == "MOZ_lightmap") number(member(item.value(), "index"), GltfKind::texture);
            textures(item.value());
        }
    }

    void texture(json& object) {
        number(member(object, "sampler"), GltfKind::sampler);
        number(member(object, "source"), GltfKind::image);
        if (json* extensions = member(object, "extensions"); extensions && extensions->is_object())
            for (json& one : *extensions) number(member(one, "source"), GltfKind::image);
    }

    void skin(json& object) {
        number(member(object, "inverseBindMatrices"), GltfKind::accessor);
        number(member(object, "skeleton"), GltfKind::node);
        numbers(member(object, "joints"), GltfKind::node);
    }

    void node(json& object) {
        number(member(object, "mesh"), GltfKind::mesh);
        number(member(object, "skin"), GltfKind::skin);
        number(member(object, "camera"), GltfKind::camera);
        numbers(member(object, "children"), GltfKind::node);
        if (json* lamp = extension(object, "KHR_lights_punctual")) number(member(*lamp, "light"), GltfKind::light);
        if (json* copies = extension(object, "EXT_mesh_gpu_instancing"))
            numbers(member(*copies, "attributes"), GltfKind::accessor);
        if (json* levels = extension(object, "MSFT_lod")) numbers(member(*levels, "ids"), GltfKind::node);
        if (json* extensions = member(object, "extensions")) textures(*extensions);
    }

    const ReferenceVisitor& visit_;
};

}  // namespace

void visit_references(GltfKind kind, json& object, const ReferenceVisitor& visit) { Visitor(visit).of(kind, object); }

std::int64_t default_scene(const json& root) {
    const std::size_t count = gltf_count(root, "scenes");
    const std::int64_t scene = json_index(root, "scene", count, "scene");
    return scene < 0 && count ? 0 : scene;
}

std::vector<std::uint64_t> scene_roots(const json& root, std::int64_t scene) {
    std::vector<std::uint64_t> roots;
    if (scene >= 0) {
        for (const json& node : json_array(gltf_item(root, "scenes", scene, "scene"), "nodes", "scene"))
            roots.push_back(json_value_size(node, "node", "scene"));
        return roots;
    }
    std::vector<bool> is_child(gltf_count(root, "nodes"), false);
    for (const json& node : json_array(root, "nodes", "nodes"))
        for (const json& child : json_array(node, "children", "nodes"))
            if (child.is_number_unsigned() && child.get<std::size_t>() < is_child.size()) is_child[child.get<std::size_t>()] = true;
    for (std::size_t node = 0; node < is_child.size(); ++node)
        if (!is_child[node]) roots.push_back(node);
    return roots;
}

}  // namespace luxel
