#include "formats/gltf/gltf_compression.h"

#include <meshoptimizer.h>

#include "formats/gltf/gltf_draco_decoder.h"
#include "formats/gltf/gltf_json.h"

namespace luxel {

using nlohmann::json;

namespace {

const std::string damaged_hint = "the file is damaged, or was packed by a newer tool; export it again";

/// Upper bound of decoded bytes per encoded byte. Vertices: a group of 16 bytes costs at least 2 header bits, so a block
/// of 256 costs 4 (64 to 1). Triangles: one byte codes 12 or less. Sequences: one byte an index. Past this the count is
/// a lie, and nothing is allocated for it.
constexpr std::uint64_t most_expansion = 64;
/// What a nearly empty stream may decode to all the same (its last block is partly filled).
constexpr std::uint64_t free_bytes = 1 << 16;

struct MeshoptView {
    ByteView encoded;
    std::uint64_t count = 0, stride = 0;
    std::string mode, filter;
};

MeshoptView read_meshopt_header(const GltfDocument& document, const json& extension, const std::string& where) {
    MeshoptView view;
    const std::int64_t buffer = json_index(extension, "buffer", document.buffers.size(), where);
    if (buffer < 0) bad_gltf(where, "meshopt: \"buffer\" is missing");
    const ByteView bytes = document.buffers[static_cast<std::size_t>(buffer)];
    const std::uint64_t offset = json_size(extension, "byteOffset", 0, where);
    const std::uint64_t length = json_size_required(extension, "byteLength", where);
    if (offset > bytes.size() || length > bytes.size() - offset)
        bad_gltf(where, "meshopt: needs bytes " + std::to_string(offset) + " to " + std::to_string(offset + length) +
                            " of buffer " + std::to_string(buffer) + ", which has " + std::to_string(bytes.size()),
                 damaged_hint);
    view.encoded = bytes.subspan(offset, length);
    view.count = json_size_required(extension, "count", where);
    view.stride = json_size_required(extension, "byteStride", where);
    view.mode = json_text(extension, "mode", "", where);
    view.filter = json_text(extension, "filter", "NONE", where);
    return view;
}

void check_meshopt(const MeshoptView& view, const std::string& where) {
    const bool vertices = view.mode == "ATTRIBUTES";
    if (!vertices && view.mode != "TRIANGLES" && view.mode != "INDICES")
        bad_gltf(where, "meshopt mode: expected ATTRIBUTES, TRIANGLES or INDICES, found \"" + view.mode + "\"");
    const bool stride_fits = vertices ? view.stride >= 4 && view.stride <= 256 && view.stride % 4 == 0
                                      : view.stride == 2 || view.stride == 4;
    if (!stride_fits)
        bad_gltf(where, "meshopt byteStride for " + view.mode + ": found " + std::to_string(view.stride) + ", expected " +
                            (vertices ? "a multiple of 4 up to 256" : "2 or 4"));
    if (view.mode == "TRIANGLES" && view.count % 3)
        bad_gltf(where, "meshopt count: expected a multiple of 3, found " + std::to_string(view.count));
    if (!vertices && view.filter != "NONE") bad_gltf(where, "meshopt filter " + view.filter + " on indices");
    if (view.count > (view.encoded.size() * most_expansion + free_bytes) / view.stride)
        bad_gltf(where, "meshopt count: " + std::to_string(view.count) + " elements cannot come from " +
                            std::to_string(view.encoded.size()) + " bytes", damaged_hint);
}

void apply_filter(const MeshoptView& view, Bytes& bytes, const std::string& where) {
    if (view.filter == "NONE") return;
    const auto wants = [&](bool fits, const char* expected) {
        if (!fits)
            bad_gltf(where, "meshopt filter " + view.filter + " wants a byteStride of " + expected + ", found " +
                                std::to_string(view.stride));
    };
    if (view.filter == "OCTAHEDRAL") {
        wants(view.stride == 4 || view.stride == 8, "4 or 8");
        meshopt_decodeFilterOct(bytes.data(), view.count, view.stride);
    } else if (view.filter == "QUATERNION") {
        wants(view.stride == 8, "8");
        meshopt_decodeFilterQuat(bytes.data(), view.count, view.stride);
    } else if (view.filter == "EXPONENTIAL") {
        meshopt_decodeFilterExp(bytes.data(), view.count, view.stride);
    } else {
        bad_gltf(where, "meshopt filter: expected NONE, OCTAHEDRAL, QUATERNION or EXPONENTIAL, found \"" + view.filter + "\"");
    }
}

template <class T>
void convert_attribute(const draco::PointAttribute& source, std::uint64_t vertex_count, AccessorBytes& out,
                       const std::string& where) {
    out.count = vertex_count;
    out.data.reserve(vertex_count * out.element_bytes());
    std::array<T, 16> values{};
    for (std::uint32_t v = 0; v < vertex_count; ++v) {
        const draco::AttributeValueIndex index = source.mapped_index(draco::PointIndex(v));
        if (index.value() >= source.size() ||
            !source.ConvertValue<T>(index, static_cast<std::int8_t>(out.components), values.data()))
            bad_gltf(where, "Draco: vertex " + std::to_string(v) + " has no value that fits the accessor", damaged_hint);
        const auto* first = reinterpret_cast<const std::uint8_t*>(values.data());
        out.data.insert(out.data.end(), first, first + out.element_bytes());
    }
}

AccessorBytes read_draco_attribute(const draco::Mesh& mesh, const DracoAttribute& wanted, const std::string& where) {
    const std::string here = where + ": Draco attribute " + wanted.semantic;
    const draco::PointAttribute* source = mesh.GetAttributeByUniqueId(wanted.unique_id);
    if (!source) bad_gltf(here, "id " + std::to_string(wanted.unique_id) + " is not in the compressed data", damaged_hint);
    AccessorBytes out = wanted.layout;
    if (static_cast<std::uint32_t>(source->num_components()) != out.components)
        bad_gltf(here, "the accessor is " + out.type + ", the compressed data has " +
                           std::to_string(source->num_components()) + " components", damaged_hint);
    // Bytes other than 0 and 1 are no values of C++'s bool, as which Draco would read them.
    if (source->data_type() == draco::DT_BOOL) bad_gltf(here, "the compressed data has truth values; expected numbers", damaged_hint);
    const std::uint64_t count = mesh.num_points();
    if (out.count != count)
        bad_gltf(here, "the accessor has " + std::to_string(out.count) + " elements, the compressed data " +
                           std::to_string(count), damaged_hint);
    switch (out.component) {
        case ComponentType::i8: convert_attribute<std::int8_t>(*source, count, out, here); break;
        case ComponentType::u8: convert_attribute<std::uint8_t>(*source, count, out, here); break;
        case ComponentType::i16: convert_attribute<std::int16_t>(*source, count, out, here); break;
        case ComponentType::u16: convert_attribute<std::uint16_t>(*source, count, out, here); break;
        case ComponentType::u32: convert_attribute<std::uint32_t>(*source, count, out, here); break;
        case ComponentType::f32: convert_attribute<float>(*source, count, out, here); break;
    }
    return out;
}

}  // namespace

const json* meshopt_extension(const json& view, const std::string& where) {
    if (const json* found = json_extension(view, "EXT_meshopt_compression", where)) return found;
    return json_extension(view, "KHR_meshopt_compression", where);
}

Bytes decode_meshopt_view(const GltfDocument& document, const json& extension, const std::string& where) {
    const MeshoptView view = read_meshopt_header(document, extension, where);
    check_meshopt(view, where);
    Bytes bytes(view.count * view.stride, std::uint8_t{0});
    if (bytes.empty()) return bytes;
    int result = 0;
    if (view.mode == "ATTRIBUTES")
        result = meshopt_decodeVertexBuffer(bytes.data(), view.count, view.stride, view.encoded.data(), view.encoded.size());
    else if (view.mode == "TRIANGLES")
        result = meshopt_decodeIndexBuffer(bytes.data(), view.count, view.stride, view.encoded.data(), view.encoded.size());
    else
        result = meshopt_decodeIndexSequence(bytes.data(), view.count, view.stride, view.encoded.data(), view.encoded.size());
    if (result != 0)
        bad_gltf(where, "meshopt: the decoder refuses the data (code " + std::to_string(result) +
                            (result == -1 ? ", another version of the format)" : ")"), damaged_hint);
    apply_filter(view, bytes, where);
    return bytes;
}

DracoMesh decode_draco(ByteView stream, const std::vector<DracoAttribute>& wanted, const std::string& where) {
    const std::unique_ptr<draco::Mesh> mesh = decode_draco_mesh(stream, where);
    DracoMesh out;
    out.vertex_count = mesh->num_points();
    for (const DracoAttribute& attribute : wanted)
        out.attributes.emplace(attribute.semantic, read_draco_attribute(*mesh, attribute, where));
    out.indices.reserve(std::size_t{3} * mesh->num_faces());
    for (draco::FaceIndex face(0); face < mesh->num_faces(); ++face)
        for (const draco::PointIndex& corner : mesh->face(face)) {
            if (corner.value() >= out.vertex_count)
                bad_gltf(where, "Draco: index " + std::to_string(corner.value()) + " of " +
                                    std::to_string(out.vertex_count) + " vertices", damaged_hint);
            out.indices.push_back(corner.value());
        }
    return out;
}

}  // namespace luxel
