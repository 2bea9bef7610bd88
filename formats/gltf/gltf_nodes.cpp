#include "formats/gltf/gltf_nodes.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "formats/gltf/gltf_accessor.h"
#include "formats/gltf/gltf_json.h"

namespace luxel {

using nlohmann::json;

namespace {

/// Paths grow with depth, so a chain costs the square of its length. No real scene comes near.
constexpr std::size_t deepest_node = 1024;

/// Row-vector matrix of scale, then rotation (x, y, z, w; any length), then translation.
Imath::M44d trs_matrix(const std::array<double, 3>& t, const std::array<double, 4>& q, const std::array<double, 3>& s) {
    const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    const bool turns = length > 0 && std::isfinite(length);
    const double x = turns ? q[0] / length : 0, y = turns ? q[1] / length : 0, z = turns ? q[2] / length : 0;
    const double w = turns ? q[3] / length : 1;
    const double rows[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)},
                               {2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)},
                               {2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)}};
    Imath::M44d m;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) m[i][j] = s[static_cast<std::size_t>(i)] * rows[i][j];
    for (int j = 0; j < 3; ++j) m[3][j] = t[static_cast<std::size_t>(j)];
    return m;
}

Imath::M44d local_matrix(const json& node, const std::string& where) {
    std::array<double, 16> columns{};
    if (json_numbers(node, "matrix", columns, where)) {
        // glTF stores columns of column vectors: in memory that is rows of row vectors.
        Imath::M44d m;
        for (std::size_t i = 0; i < 16; ++i) m[static_cast<int>(i / 4)][static_cast<int>(i % 4)] = columns[i];
        return m;
    }
    std::array<double, 3> t{0, 0, 0}, s{1, 1, 1};
    std::array<double, 4> q{0, 0, 0, 1};
    json_numbers(node, "translation", t, where);
    json_numbers(node, "rotation", q, where);
    json_numbers(node, "scale", s, where);
    return trs_matrix(t, q, s);
}

std::string escaped(const std::string& name) {
    std::string out;
    for (const char c : name) {
        if (c == '/') out += "%2F";
        else if (c == '@') out += "%40";
        else if (c == '%') out += "%25";
        else out += c;
    }
    return out;
}

/// Custom properties "radius" and "angle" of `extras`, which may be anything and belong to whoever wrote them: what is
/// no number is somebody else's.
void read_lamp_size(const json& owner, LampRecord& lamp, const std::string& where) {
    const auto extras = owner.find("extras");
    if (extras == owner.end() || !extras->is_object()) return;
    const auto number = [&](const char* key, double& value) {
        const auto found = extras->find(key);
        if (found != extras->end() && found->is_number()) value = json_number(*extras, key, value, where + ": extras");
    };
    if (lamp.kind == LampKind::directional) number("angle", lamp.angle_degrees);
    else number("radius", lamp.radius);
}

class NodeWalk {
  public:
    NodeWalk(const GltfDocument& document, bool skip_skinned, SceneRecord& record)
        : document_(document), record_(record), skip_skinned_(skip_skinned), node_count_(gltf_count(document.json, "nodes")), state_(node_count_) {}

    /// Depth first, with a stack of its own: the depth of a file must not cost the program's.
    void walk(const json& roots, const std::string& where) {
        std::vector<Level> levels;
        levels.emplace_back();
        levels.back().children = &roots;
        levels.back().where = where;
        while (!levels.empty()) {
            if (levels.back().next == levels.back().children->size()) {
                if (levels.back().node >= 0) state_[static_cast<std::size_t>(levels.back().node)] = State::done;
                levels.pop_back();
            } else {
                Level inner = enter(levels.back(), levels.size());
                levels.push_back(std::move(inner));
            }
        }
    }

    /// Nodes that are nobody's child, for a file without scenes.
    [[nodiscard]] json all_roots() const {
        std::vector<bool> is_child(node_count_);
        for (std::size_t n = 0; n < node_count_; ++n) {
            const json& node = gltf_item(document_.json, "nodes", static_cast<std::int64_t>(n), document_.name);
            for (const json& child : json_array(node, "children", document_.name))
                if (child.is_number_unsigned() && child.get<std::uint64_t>() < node_count_)
                    is_child[child.get<std::size_t>()] = true;
        }
        json roots = json::array();
        for (std::size_t n = 0; n < node_count_; ++n)
            if (!is_child[n]) roots.push_back(n);
        return roots;
    }

  private:
    enum class State : std::uint8_t { unseen, open, done };

    /// An open node, or the scene itself (node -1), and how far its children are done.
    struct Level {
        std::int64_t node = -1;
        const json* children = nullptr;
        std::size_t next = 0;
        std::string path, where;
        Imath::M44d world;
        std::map<std::string, int> used_names;  ///< of children seen so far, with the last number tried for each
    };

    std::int64_t claim(const json& index, const std::string& where, std::size_t depth) {
        const std::uint64_t n = json_value_size(index, "node", where);
        if (n >= node_count_)
            bad_gltf(where, "node " + std::to_string(n) + " is wanted, but the file has only " + std::to_string(node_count_));
        if (state_[n] == State::open)
            bad_gltf(where, "node " + std::to_string(n) + " is its own ancestor: the node tree has a cycle");
        if (state_[n] == State::done)
            bad_gltf(where, "node " + std::to_string(n) + " has more than one parent, or is listed twice");
        if (depth > deepest_node)
            bad_gltf(where, "the node tree is deeper than " + std::to_string(deepest_node) + " levels");
        return static_cast<std::int64_t>(n);
    }

    /// "chair", "chair:1" ...: unique among the siblings seen so far.
    static std::string sibling_name(const json& node, std::int64_t n, std::map<std::string, int>& used,
                                    const std::string& where) {
        std::string name = escaped(json_text(node, "name", "", where));
        if (name.empty()) name.append(1, '#').append(std::to_string(n));
        std::string unique = name;
        while (!used.emplace(unique, 0).second) unique = name + ':' + std::to_string(++used[name]);
        return unique;
    }

    /// Reads the next child of `parent` and gives the level of that child's own children.
    Level enter(Level& parent, std::size_t depth) {
        const std::int64_t n = claim((*parent.children)[parent.next++], parent.where, depth);
        state_[static_cast<std::size_t>(n)] = State::open;
        const json& node = gltf_item(document_.json, "nodes", n, document_.name);
        Level level;
        level.node = n;
        level.where = document_.name + ": " + gltf_name(node, "node", n);
        level.path = parent.path + '/' + sibling_name(node, n, parent.used_names, level.where);
        level.world = local_matrix(node, level.where) * parent.world;
        level.children = &json_array(node, "children", level.where);
        add_mesh(node, n, level.path, level.world, level.where);
        add_lamp(node, level.path, level.world, level.where);
        return level;
    }

    void add_mesh(const json& node, std::int64_t n, const std::string& path, const Imath::M44d& world,
                  const std::string& where) {
        const std::int64_t mesh = json_index(node, "mesh", gltf_count(document_.json, "meshes"), where);
        if (mesh < 0) return;
        if (json_index(node, "skin", gltf_count(document_.json, "skins"), where) >= 0) {
            if (skip_skinned_) return record_.warnings.push_back({"skinned-skipped", where, "has a skin: left out, it neither gets light nor stops it"});
            record_.warnings.push_back({"skinned-rest-pose", where, "the skin is ignored: the mesh is baked in its rest pose"});
        }
        InstanceRecord instance;
        instance.node = static_cast<int>(n);
        instance.mesh = static_cast<int>(mesh);
        instance.node_path = path;
        instance.world = world;
        if (const json* copies = json_extension(node, "EXT_mesh_gpu_instancing", where)) {
            add_copies(*copies, instance, where);
        } else {
            record_.instances.push_back(std::move(instance));
        }
    }

    /// One column of EXT_mesh_gpu_instancing as doubles, empty if the file has none.
    std::vector<float> copy_column(const json& attributes, const char* semantic, const char* type, std::uint64_t& count,
                                   const std::string& where) {
        if (!attributes.contains(semantic)) return {};
        const std::string here = where + ": EXT_mesh_gpu_instancing " + semantic;
        const auto accessor = static_cast<std::int64_t>(json_size_required(attributes, semantic, here));
        const AccessorBytes elements = read_elements(document_, accessor, here);
        if (elements.type != type) bad_gltf(here, std::string("expected ") + type + ", found " + elements.type);
        if (count != unknown_count && count != elements.count)
            bad_gltf(here, "has " + std::to_string(elements.count) + " elements, another attribute has " + std::to_string(count));
        count = elements.count;
        return to_floats(elements);
    }

    void add_copies(const json& extension, const InstanceRecord& node, const std::string& where) {
        const json& attributes = json_object(extension, "attributes", where);
        std::uint64_t count = unknown_count;
        const auto t = copy_column(attributes, "TRANSLATION", "VEC3", count, where);
        const auto q = copy_column(attributes, "ROTATION", "VEC4", count, where);
        const auto s = copy_column(attributes, "SCALE", "VEC3", count, where);
        if (count == unknown_count) count = 0;
        for (std::uint64_t k = 0; k < count; ++k) {
            const auto at = [&](const std::vector<float>& column, std::uint64_t width, std::uint64_t c, double otherwise) {
                return column.empty() ? otherwise : static_cast<double>(column[k * width + c]);
            };
            InstanceRecord copy = node;
            copy.node_path.append(1, '@').append(std::to_string(k));
            copy.gpu_instance = static_cast<int>(k);
            copy.world = trs_matrix({at(t, 3, 0, 0), at(t, 3, 1, 0), at(t, 3, 2, 0)},
                                    {at(q, 4, 0, 0), at(q, 4, 1, 0), at(q, 4, 2, 0), at(q, 4, 3, 1)},
                                    {at(s, 3, 0, 1), at(s, 3, 1, 1), at(s, 3, 2, 1)}) * node.world;
            record_.instances.push_back(std::move(copy));
        }
    }

    void add_lamp(const json& node, const std::string& path, const Imath::M44d& world, const std::string& where) {
        const json* reference = json_extension(node, "KHR_lights_punctual", where);
        if (!reference) return;
        const json* list = json_extension(document_.json, "KHR_lights_punctual", document_.name);
        const json& lights = list ? json_array(*list, "lights", document_.name) : json_array(json::object(), "lights", where);
        const std::int64_t index = json_index(*reference, "light", lights.size(), where + ": KHR_lights_punctual");
        if (index < 0) return;
        const json& light = lights[static_cast<std::size_t>(index)];
        const std::string here = where + ": " + gltf_name(light, "light", index);
        LampRecord lamp;
        const std::string type = json_text(light, "type", "", here);
        if (type == "directional") lamp.kind = LampKind::directional;
        else if (type == "spot") lamp.kind = LampKind::spot;
        else if (type != "point") bad_gltf(here, "type: expected point, spot or directional, found \"" + type + "\"");
        std::array<double, 3> color{1, 1, 1};
        json_numbers(light, "color", color, here);
        const double intensity = json_number(light, "intensity", 1, here);
        for (std::size_t c = 0; c < 3; ++c) lamp.intensity[c] = color[c] * intensity;
        lamp.range = json_number(light, "range", 0, here);
        if (light.contains("range") && !(lamp.range > 0))
            record_.warnings.push_back({"lamp-range", here, "range: expected more than 0: counts as unlimited"});
        read_lamp_size(light, lamp, here);
        read_lamp_size(node, lamp, where);
        const json& spot = json_object(light, "spot", here);
        lamp.inner_cone = json_number(spot, "innerConeAngle", lamp.inner_cone, here);
        lamp.outer_cone = json_number(spot, "outerConeAngle", lamp.outer_cone, here);
        lamp.node_path = path;
        lamp.world = world;
        record_.lamps.push_back(std::move(lamp));
    }

    static constexpr std::uint64_t unknown_count = ~std::uint64_t{0};
    const GltfDocument& document_;
    SceneRecord& record_;
    bool skip_skinned_;
    std::size_t node_count_;
    std::vector<State> state_;
};

}  // namespace

void read_nodes(const GltfDocument& document, int scene, bool skip_skinned, SceneRecord& record) {
    const std::size_t scene_count = gltf_count(document.json, "scenes");
    NodeWalk walk(document, skip_skinned, record);
    std::int64_t chosen = scene >= 0 ? scene : json_index(document.json, "scene", scene_count, document.name);
    if (chosen < 0 && scene_count > 0) chosen = 0;
    if (chosen < 0) {
        walk.walk(walk.all_roots(), document.name);
        return;
    }
    const json& item = gltf_item(document.json, "scenes", chosen, document.name);
    const std::string where = document.name + ": " + gltf_name(item, "scene", chosen);
    if (scene_count > 1)
        record.warnings.push_back({"other-scenes", where, "only this one of " + std::to_string(scene_count) + " scenes is read"});
    walk.walk(json_array(item, "nodes", where), where);
}

}  // namespace luxel
