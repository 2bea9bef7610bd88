#include "formats/gltf/gltf_out_draco.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "formats/gltf/gltf_compression.h"
#include "formats/gltf/gltf_encode.h"
#include "formats/gltf/gltf_json.h"
#include "formats/gltf/gltf_out_arrays.h"

namespace luxel {

using nlohmann::json;

namespace {

constexpr const char* draco_extension = "KHR_draco_mesh_compression";
constexpr std::uint64_t mode_triangles = 4;

/// A primitive as arrays, each accessor once, however many semantics name it.
struct SourceArrays {
    std::vector<DracoInput> inputs;
    std::vector<std::uint64_t> accessors;         ///< per input
    std::map<std::string, std::size_t> input_of;  ///< by semantic
    std::vector<std::uint32_t> indices;
};

/// What replaces the arrays of a primitive, and its numbers once it is in the model.
struct Compressed {
    std::uint64_t plain_bytes = 0, packed_bytes = 0;
    DracoStream stream;
    std::vector<json> accessors;                  ///< per input
    std::map<std::string, std::size_t> input_of;  ///< by semantic
    json indices;                                 ///< their accessor

    bool is_placed = false;
    json attributes, extension;
    std::uint64_t indices_number = 0;
};

/// Bounds of the finite values of an array, or of several.
struct Box {
    std::array<float, 4> low, high;
    Box() {
        low.fill(std::numeric_limits<float>::infinity());
        high.fill(-std::numeric_limits<float>::infinity());
    }
    void add(const AccessorBytes& array) {
        const std::vector<float> values = to_floats(array);
        for (std::size_t k = 0; k < values.size(); ++k) {
            const std::size_t c = k % array.components;
            if (!std::isfinite(values[k])) continue;
            low[c] = std::min(low[c], values[k]);
            high[c] = std::max(high[c], values[k]);
        }
    }
    void add(const Box& other) {
        for (std::size_t c = 0; c < low.size(); ++c) {
            low[c] = std::min(low[c], other.low[c]);
            high[c] = std::max(high[c], other.high[c]);
        }
    }
    [[nodiscard]] float extent() const {
        float most = 0;
        for (std::size_t c = 0; c < low.size(); ++c) most = std::max(most, high[c] - low[c]);
        return most;
    }
    [[nodiscard]] bool lies_in(float least, float most) const {
        for (std::size_t c = 0; c < low.size(); ++c)
            if (low[c] < least || high[c] > most) return false;
        return true;
    }
};

int bits_of(const std::string& semantic, const AccessorBytes& elements, const DracoBits& bits, std::uint32_t page_size) {
    if (semantic == "POSITION") return bits.position;
    if (semantic == "NORMAL") return bits.normal;
    if (semantic.starts_with("COLOR_")) return bits.color;
    if (!semantic.starts_with("TEXCOORD_")) return bits.other;
    const int wanted = semantic == "TEXCOORD_1" ? lightmap_bits(bits, page_size) : bits.texcoord;
    Box box;
    box.add(elements);
    const float repeats = box.extent();
    return repeats > 1 ? std::min(most_draco_bits, wanted + static_cast<int>(std::ceil(std::log2(repeats)))) : wanted;
}

/// A grid whose ends are numbers that have to stay what they are: the sign in a tangent's w, no weight at all.
std::optional<QuantisationGrid> grid_of(const std::string& semantic, const AccessorBytes& elements) {
    const bool is_tangent = semantic == "TANGENT";
    if (!is_tangent && !semantic.starts_with("WEIGHTS_") && !semantic.starts_with("COLOR_")) return std::nullopt;
    Box box;
    box.add(elements);
    if (is_tangent && box.lies_in(-1, 1)) return QuantisationGrid{{-1, -1, -1, -1}, 2};
    if (!is_tangent && box.lies_in(0, 1)) return QuantisationGrid{{0, 0, 0, 0}, 1};
    return std::nullopt;
}

class DracoPass {
  public:
    DracoPass(OutputModel& model, const DracoBits& bits, std::uint32_t page_size, ArrayReferences& replaced)
        : model_(model), bits_(bits), page_size_(page_size), replaced_(replaced) {}

    void run() {
        for (std::size_t mesh = 0; mesh < gltf_count(model_.root, "meshes"); ++mesh) {
            json& item = model_.root["meshes"][mesh];
            if (!item.is_object()) continue;
            const std::string name = model_.document.name + ": " + gltf_name(item, "mesh", static_cast<std::int64_t>(mesh));
            const auto primitives = item.find("primitives");
            if (primitives == item.end() || !primitives->is_array()) continue;
            compress_mesh(*primitives, name);
        }
    }

  private:
    /// Triangles whose parts have the types that they should have: nobody may have read this mesh.
    static bool is_candidate(const json& primitive) {
        if (!primitive.is_object()) return false;
        if (const auto mode = primitive.find("mode"); mode != primitive.end() && *mode != mode_triangles) return false;
        const auto extensions = primitive.find("extensions");
        if (extensions != primitive.end() && (!extensions->is_object() || extensions->contains(draco_extension))) return false;
        const auto attributes = primitive.find("attributes");
        return attributes != primitive.end() && attributes->is_object() && attributes->contains("POSITION");
    }

    /// Around the positions of everything that is compressed; bounds are found once per array.
    QuantisationGrid grid_of_mesh(const json& primitives) {
        Box box;
        for (const json& primitive : primitives) {
            if (!is_candidate(primitive)) continue;
            const json& accessor = primitive["attributes"]["POSITION"];
            try {
                const std::uint64_t index = json_value_size(accessor, "POSITION", model_.document.name);
                auto known = position_boxes_.find(index);
                if (known == position_boxes_.end()) {
                    known = position_boxes_.emplace(index, Box()).first;
                    known->second.add(model_.elements(static_cast<std::int64_t>(index), model_.document.name));
                }
                box.add(known->second);
            } catch (const Error&) {  // the same fault is told, and the primitive left as it is, when it is compressed
            }
        }
        const float extent = box.extent();
        return {box.low, extent > 0 && std::isfinite(extent) ? extent : 1.0f};
    }

    /// All primitives of a mesh or none: on the common grid they meet each other, but not the plain ones.
    void compress_mesh(json& primitives, const std::string& name) {
        const QuantisationGrid grid = grid_of_mesh(primitives);
        std::vector<std::optional<Compressed>*> found(primitives.size(), nullptr);
        std::uint64_t plain_bytes = 0, packed_bytes = 0;
        for (std::size_t p = 0; p < primitives.size(); ++p) {
            if (!is_candidate(primitives[p])) continue;
            found[p] = &compressed(primitives[p], grid, name + " primitive " + std::to_string(p));
            if (!*found[p]) continue;
            plain_bytes += (*found[p])->plain_bytes;
            packed_bytes += (*found[p])->packed_bytes;
        }
        if (packed_bytes >= plain_bytes) return;
        for (std::size_t p = 0; p < primitives.size(); ++p)
            if (found[p] && *found[p]) replace(primitives[p], **found[p]);
    }

    std::optional<Compressed>& compressed(const json& primitive, const QuantisationGrid& grid, const std::string& where) {
        const bool has_targets = primitive.contains("targets") && !primitive["targets"].empty();
        const json key = {primitive["attributes"], primitive.value("indices", json()), has_targets, grid.origin, grid.range};
        const auto known = known_.find(key);
        if (known != known_.end()) return known->second;
        std::optional<Compressed> made;
        try {
            made = encode(primitive, grid, has_targets, where);
        } catch (const Error& error) {
            model_.warnings.push_back({"draco-left-out", where, error.what_text + "; its arrays are stored plain"});
        }
        return known_.emplace(key, std::move(made)).first->second;
    }

    void replace(json& primitive, Compressed& compressed) {
        place(compressed);
        json released = {{"attributes", primitive["attributes"]}};
        if (primitive.contains("indices")) released["indices"] = primitive["indices"];
        collect_references({{"primitives", json::array({std::move(released)})}}, replaced_);
        primitive["attributes"] = compressed.attributes;
        primitive["indices"] = compressed.indices_number;
        primitive["extensions"][draco_extension] = compressed.extension;
        require_extension(model_.root, draco_extension);
    }

    void place(Compressed& compressed) {
        if (compressed.is_placed) return;
        compressed.is_placed = true;
        std::vector<std::uint64_t> numbers;
        for (json& accessor : compressed.accessors) numbers.push_back(model_.append("accessors", std::move(accessor)));
        for (const auto& [semantic, input] : compressed.input_of) {
            compressed.attributes[semantic] = numbers[input];
            compressed.extension["attributes"][semantic] = compressed.stream.unique_ids[input];
        }
        compressed.extension["bufferView"] = model_.append_view({-1, {}, std::move(compressed.stream.bytes)});
        compressed.indices_number = model_.append("accessors", std::move(compressed.indices));
    }

    SourceArrays read(const json& primitive, const QuantisationGrid& grid, const std::string& where) const {
        SourceArrays source;
        for (const auto& [semantic, accessor] : primitive["attributes"].items()) {
            const std::string here = where + ": " + semantic;
            const std::uint64_t index = json_value_size(accessor, "accessor", here);
            const auto known = std::find(source.accessors.begin(), source.accessors.end(), index);
            const auto input = static_cast<std::size_t>(known - source.accessors.begin());
            source.input_of[semantic] = input;
            if (known == source.accessors.end()) {
                source.accessors.push_back(index);
                source.inputs.push_back({semantic, model_.elements(static_cast<std::int64_t>(index), here), 1, {}});
            }
            DracoInput& one = source.inputs[input];
            one.bits = std::max(one.bits, bits_of(semantic, one.elements, bits_, page_size_));
            if (semantic == "POSITION") one.grid = grid;
            else if (!one.grid) one.grid = grid_of(semantic, one.elements);
        }
        const std::uint64_t count = source.inputs[0].elements.count;
        for (const DracoInput& input : source.inputs)
            if (input.elements.count != count)
                bad_gltf(where, input.semantic + " has " + std::to_string(input.elements.count) + " elements, " +
                                    source.inputs[0].semantic + " has " + std::to_string(count));
        read_indices(primitive, count, where, source.indices);
        return source;
    }

    void read_indices(const json& primitive, std::uint64_t count, const std::string& where,
                      std::vector<std::uint32_t>& indices) const {
        if (count >= std::numeric_limits<std::uint32_t>::max()) bad_gltf(where, "has too many vertices");
        if (primitive.contains("indices")) {
            const auto index = static_cast<std::int64_t>(json_size_required(primitive, "indices", where));
            indices = to_indices(model_.elements(index, where), where);
        } else {
            for (std::uint32_t k = 0; k < count; ++k) indices.push_back(k);
        }
        indices.resize(indices.size() / 3 * 3);
        for (const std::uint32_t index : indices)
            if (index >= count) bad_gltf(where, "index " + std::to_string(index) + " of " + std::to_string(count) + " vertices");
    }

    /// Nothing if there is nothing to compress.
    std::optional<Compressed> encode(const json& primitive, const QuantisationGrid& grid, bool has_targets,
                                     const std::string& where) {
        const SourceArrays source = read(primitive, grid, where);
        const auto is_matrix = [](const DracoInput& input) { return input.elements.type.starts_with("MAT"); };
        if (source.indices.empty() || std::ranges::any_of(source.inputs, is_matrix)) return std::nullopt;
        DracoStream stream =
            encode_draco(source.inputs, source.indices, has_targets ? DracoOrder::in_order : DracoOrder::free, where);
        std::vector<DracoAttribute> wanted;
        for (std::size_t k = 0; k < source.inputs.size(); ++k) {
            AccessorBytes layout = source.inputs[k].elements;
            layout.data.clear();
            layout.count = stream.vertex_count;
            wanted.push_back({source.inputs[k].semantic, stream.unique_ids[k], std::move(layout)});
        }
        const DracoMesh decoded = decode_draco(stream.bytes, wanted, where);
        if (has_targets && (decoded.indices != source.indices || decoded.vertex_count != source.inputs[0].elements.count))
            bad_gltf(where, "Draco changes the order of its vertices, which its morph targets need");
        return describe(primitive, source, decoded, std::move(stream));
    }

    Compressed describe(const json& primitive, const SourceArrays& source, const DracoMesh& decoded, DracoStream stream) const {
        Compressed out;
        out.input_of = source.input_of;
        for (std::size_t k = 0; k < source.inputs.size(); ++k) {
            json accessor = promise(source.accessors[k], decoded.vertex_count);
            if (accessor.contains("min") || accessor.contains("max") || source.inputs[k].semantic == "POSITION")
                set_bounds(decoded.attributes.at(source.inputs[k].semantic), accessor);
            out.accessors.push_back(std::move(accessor));
            out.plain_bytes += source.inputs[k].elements.data.size();
        }
        out.indices = primitive.contains("indices") ? promise(primitive["indices"].get<std::uint64_t>(), 0) : json::object();
        const ComponentType component = decoded.vertex_count <= 65535 ? ComponentType::u16 : ComponentType::u32;
        out.indices["componentType"] = static_cast<int>(component);
        out.indices["type"] = "SCALAR";
        out.indices["count"] = decoded.indices.size();
        if (out.indices.contains("min") || out.indices.contains("max")) {
            const auto [least, most] = std::ranges::minmax(decoded.indices);
            out.indices["min"] = {least};
            out.indices["max"] = {most};
        }
        out.plain_bytes += source.indices.size() * component_bytes(component);
        out.packed_bytes = stream.bytes.size();
        out.stream = std::move(stream);
        return out;
    }

    /// The accessor without data of its own.
    [[nodiscard]] json promise(std::uint64_t accessor, std::uint64_t count) const {
        json item = model_.root["accessors"][accessor];
        for (const char* key : {"bufferView", "byteOffset", "sparse"}) item.erase(key);
        item["count"] = count;
        return item;
    }

    OutputModel& model_;
    const DracoBits& bits_;
    std::uint32_t page_size_;
    ArrayReferences& replaced_;
    std::map<std::uint64_t, Box> position_boxes_;         ///< by accessor
    std::map<json, std::optional<Compressed>> known_;     ///< by what decides the result
};

}  // namespace

void compress_draco(OutputModel& model, const DracoBits& bits, std::uint32_t page_size, ArrayReferences& replaced) {
    DracoPass(model, bits, page_size, replaced).run();
}

}  // namespace luxel
