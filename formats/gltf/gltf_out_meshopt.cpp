#include "formats/gltf/gltf_out_meshopt.h"

#include <algorithm>
#include <map>
#include <set>

#include "formats/gltf/gltf_encode.h"
#include "formats/gltf/gltf_json.h"

namespace luxel {

using nlohmann::json;

namespace {

constexpr const char* meshopt_extension_name = "EXT_meshopt_compression";
constexpr std::uint64_t mode_triangles = 4, longest_element_bytes = 256;
/// What the JSON of a packed view is longer than that of a plain one.
constexpr std::uint64_t description_bytes = 150;

/// What an accessor promises of its elements, as far as it matters here.
struct Elements {
    ComponentType component = ComponentType::f32;
    std::uint64_t bytes = 0, offset = 0, count = 0;  ///< of one; in the view; elements
    bool is_matrix = false;
};

/// Who uses a view.
struct ViewUse {
    std::vector<Elements> arrays;    ///< of vertices, animations, matrices
    std::vector<Elements> indices;
    bool only_triangles = true;      ///< all its indices
    bool only_accessors = true;      ///< and those without sparse parts
};

std::optional<std::size_t> number(const json& object, const char* key) {
    if (!object.is_object()) return std::nullopt;
    const auto found = object.find(key);
    if (found == object.end() || !found->is_number_unsigned()) return std::nullopt;
    return found->get<std::size_t>();
}

class ViewUses {
  public:
    explicit ViewUses(const OutputModel& model) : model_(model), uses_(model.views.size()) {
        find_indices();
        for (std::size_t accessor = 0; accessor < gltf_count(model.root, "accessors"); ++accessor) add_accessor(accessor);
        for (const json& image : json_array(model.root, "images", model.document.name)) block(image);
    }
    [[nodiscard]] const ViewUse& operator[](std::size_t view) const { return uses_[view]; }

  private:
    void find_indices() {
        for (const json& mesh : json_array(model_.root, "meshes", model_.document.name))
            for (const json& primitive : json_array(mesh, "primitives", model_.document.name)) {
                if (const json* draco = json_extension(primitive, "KHR_draco_mesh_compression", model_.document.name)) block(*draco);
                const auto indices = number(primitive, "indices");
                if (!indices) continue;
                const bool are_triangles = number(primitive, "mode").value_or(mode_triangles) == mode_triangles;
                auto [known, is_new] = are_triangles_.emplace(*indices, are_triangles);
                known->second = known->second && are_triangles;
            }
    }

    void block(const json& user) {
        if (const auto view = number(user, "bufferView"); view && *view < uses_.size()) uses_[*view].only_accessors = false;
    }

    void add_accessor(std::size_t accessor) {
        const json& item = model_.root["accessors"][accessor];
        const std::string where = model_.document.name + ": accessor " + std::to_string(accessor);
        if (item.contains("sparse")) {
            const json& sparse = json_object(item, "sparse", where);
            block(json_object(sparse, "indices", where));
            block(json_object(sparse, "values", where));
        }
        const auto view = number(item, "bufferView");
        if (!view || *view >= uses_.size()) return;
        ViewUse& use = uses_[*view];
        try {
            const AccessorBytes layout = describe_accessor(model_.root, static_cast<std::int64_t>(accessor), where);
            const Elements elements{layout.component, layout.element_bytes(), json_size(item, "byteOffset", 0, where), layout.count,
                                    layout.type.starts_with("MAT")};
            const auto indices = are_triangles_.find(accessor);
            if (indices != are_triangles_.end()) use.only_triangles = use.only_triangles && indices->second;
            (indices == are_triangles_.end() ? use.arrays : use.indices).push_back(elements);
        } catch (const Error&) {  // damaged, and nobody reads it
            use.only_accessors = false;
        }
    }

    const OutputModel& model_;
    std::vector<ViewUse> uses_;
    std::map<std::size_t, bool> are_triangles_;  ///< by accessor with indices: all that it serves are triangle lists
};

/// Bytes from one element to the next, 0 if the codec cannot take them.
std::uint64_t element_step(const ViewUse& use, std::uint64_t view_stride) {
    std::uint64_t step = view_stride ? view_stride : use.arrays[0].bytes;
    for (const Elements& array : use.arrays) {
        const bool is_padded = array.is_matrix && array.component != ComponentType::f32;
        if (is_padded || (!view_stride && array.bytes != step)) return 0;
    }
    return step % 4 == 0 && step <= longest_element_bytes ? step : 0;
}

std::optional<MeshoptBytes> pack_arrays(const ViewUse& use, ByteView bytes, std::uint64_t view_stride) {
    const std::uint64_t step = element_step(use, view_stride);
    if (!step || bytes.size() % step) return std::nullopt;
    return MeshoptBytes{encode_meshopt_vertices(bytes, step), "ATTRIBUTES", bytes.size() / step, step};
}

std::optional<MeshoptBytes> pack_indices(const ViewUse& use, ByteView bytes) {
    const ComponentType component = use.indices[0].component;
    const std::uint64_t step = component_bytes(component);
    if ((component != ComponentType::u16 && component != ComponentType::u32) || bytes.size() % step) return std::nullopt;
    bool are_triangles = use.only_triangles && bytes.size() / step % 3 == 0;
    for (const Elements& indices : use.indices) {
        if (indices.component != component || indices.bytes != step) return std::nullopt;
        are_triangles = are_triangles && indices.offset % (3 * step) == 0 && indices.count % 3 == 0;
    }
    AccessorBytes all;
    all.component = component;
    all.count = bytes.size() / step;
    all.data.assign(bytes.begin(), bytes.end());
    const std::vector<std::uint32_t> numbers = to_indices(all, "indices");
    return MeshoptBytes{are_triangles ? encode_meshopt_triangles(numbers) : encode_meshopt_sequence(numbers),
                        are_triangles ? "TRIANGLES" : "INDICES", all.count, step};
}

std::optional<MeshoptBytes> pack(const OutputModel& model, std::size_t view, const ViewUse& use) {
    if (!use.only_accessors || use.arrays.empty() == use.indices.empty()) return std::nullopt;
    const std::string where = model.document.name + ": bufferView " + std::to_string(view);
    const ByteView bytes = model.view_bytes(view, where);
    if (bytes.empty()) return std::nullopt;
    std::optional<MeshoptBytes> packed =
        use.indices.empty() ? pack_arrays(use, bytes, model.view_stride(view, where)) : pack_indices(use, bytes);
    return packed && packed->bytes.size() + description_bytes < bytes.size() ? std::move(packed) : std::nullopt;
}

}  // namespace

void pack_meshopt(OutputModel& model) {
    std::optional<ViewUses> found;
    try {
        found.emplace(model);
    } catch (const Error& error) {  // in a part that nobody has read: the model must not be lost for its sake
        model.warnings.push_back({"meshopt-left-out", error.where, error.what_text + "; all arrays are stored plain"});
        return;
    }
    const ViewUses& uses = *found;
    for (std::size_t view = 0; view < model.views.size(); ++view) {
        try {
            model.views[view].packed = pack(model, view, uses[view]);
        } catch (const Error&) {  // the writer of the files tells of it
        }
        if (model.views[view].packed) require_extension(model.root, meshopt_extension_name);
    }
}

}  // namespace luxel
