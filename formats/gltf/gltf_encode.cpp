#include "formats/gltf/gltf_encode.h"

#include <draco/compression/expert_encode.h>
#include <meshoptimizer.h>

#include <algorithm>
#include <cmath>

#include "formats/gltf/gltf_json.h"

namespace luxel {

namespace {

/// Of 0 (smallest) to 10. 0 and 1 choose among several parallelograms for each vertex, by the entropy of what was coded so
/// far; the library counts that in a table with a place for every number that occurs, so it has to have few bits.
constexpr int thorough_speed = 1, plain_speed = 2, most_bits_for_thorough = 18;

int draco_speed(std::span<const DracoInput> attributes) {
    for (const DracoInput& attribute : attributes) {
        const ComponentType component = attribute.elements.component;
        const int bits = component == ComponentType::f32 ? attribute.bits : static_cast<int>(8 * component_bytes(component));
        if (bits > most_bits_for_thorough) return plain_speed;
    }
    return thorough_speed;
}

draco::DataType data_type(ComponentType component) {
    switch (component) {
        case ComponentType::i8: return draco::DT_INT8;
        case ComponentType::u8: return draco::DT_UINT8;
        case ComponentType::i16: return draco::DT_INT16;
        case ComponentType::u16: return draco::DT_UINT16;
        case ComponentType::u32: return draco::DT_UINT32;
        case ComponentType::f32: return draco::DT_FLOAT32;
    }
    return draco::DT_INVALID;
}

/// The kind decides how values are predicted. Normals and coordinates stored as integers are plain numbers for it, since
/// its predictions of both start from quantised floats.
draco::GeometryAttribute::Type attribute_kind(const DracoInput& attribute) {
    if (attribute.semantic == "POSITION") return draco::GeometryAttribute::POSITION;
    if (attribute.semantic.starts_with("COLOR_")) return draco::GeometryAttribute::COLOR;
    if (attribute.elements.component != ComponentType::f32) return draco::GeometryAttribute::GENERIC;
    if (attribute.semantic == "NORMAL" && attribute.elements.components == 3) return draco::GeometryAttribute::NORMAL;
    if (attribute.semantic.starts_with("TEXCOORD_")) return draco::GeometryAttribute::TEX_COORD;
    return draco::GeometryAttribute::GENERIC;
}

/// The library itself would take such numbers, and ask for all the memory there is.
void check_numbers(const DracoInput& attribute, const std::string& where) {
    if (attribute.elements.component == ComponentType::u32) bad_gltf(where, attribute.semantic + " has integers of 32 bits, too many for Draco");
    if (attribute.elements.component != ComponentType::f32) return;
    for (const float value : to_floats(attribute.elements))
        if (!std::isfinite(value)) bad_gltf(where, attribute.semantic + " has numbers that are not finite, which Draco cannot take");
}

int add_attribute(draco::Mesh& mesh, const DracoInput& attribute) {
    const AccessorBytes& elements = attribute.elements;
    const std::uint64_t step = elements.element_bytes();
    draco::GeometryAttribute description;
    description.Init(attribute_kind(attribute), nullptr, static_cast<std::uint8_t>(elements.components),
                     data_type(elements.component), elements.normalized, static_cast<std::int64_t>(step), 0);
    const auto count = static_cast<std::uint32_t>(elements.count);
    const int id = mesh.AddAttribute(description, true, count);
    for (std::uint32_t k = 0; k < count; ++k)
        mesh.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(k), elements.data.data() + k * step);
    return id;
}

/// A buffer as large as the worst case, cut to what `encode(data, size)` has written.
template <class Encode>
Bytes encode_into(std::size_t bound, const Encode& encode) {
    Bytes bytes(bound, std::uint8_t{0});
    bytes.resize(encode(bytes.data(), bytes.size()));
    bytes.shrink_to_fit();
    return bytes;
}

/// The library starts with a version that the extension does not allow.
void use_index_version() {
    [[maybe_unused]] static const bool once = (meshopt_encodeIndexVersion(1), true);
}

/// What the bounds of the library want to know: one more than the largest index.
std::size_t vertex_bound(std::span<const std::uint32_t> indices) {
    std::size_t bound = 1;
    for (const std::uint32_t index : indices) bound = std::max(bound, std::size_t{index} + 1);
    return bound;
}

}  // namespace

DracoStream encode_draco(std::span<const DracoInput> attributes, std::span<const std::uint32_t> indices,
                         DracoOrder order, const std::string& where) {
    draco::Mesh mesh;
    mesh.SetNumFaces(indices.size() / 3);
    for (std::uint32_t face = 0; face < indices.size() / 3; ++face)
        mesh.SetFace(draco::FaceIndex(face), {draco::PointIndex(indices[3 * face]), draco::PointIndex(indices[3 * face + 1]),
                                              draco::PointIndex(indices[3 * face + 2])});
    mesh.set_num_points(static_cast<std::uint32_t>(attributes[0].elements.count));
    std::vector<int> ids;
    DracoStream stream;
    for (const DracoInput& attribute : attributes) {
        check_numbers(attribute, where);
        ids.push_back(add_attribute(mesh, attribute));
        stream.unique_ids.push_back(mesh.attribute(ids.back())->unique_id());
    }
    if (order == DracoOrder::free) {
        mesh.DeduplicateAttributeValues();
        mesh.DeduplicatePointIds();
    }
    draco::ExpertEncoder encoder(mesh);
    const int speed = draco_speed(attributes);
    encoder.SetSpeedOptions(speed, speed);
    encoder.SetEncodingMethod(order == DracoOrder::free ? draco::MESH_EDGEBREAKER_ENCODING : draco::MESH_SEQUENTIAL_ENCODING);
    for (std::size_t k = 0; k < attributes.size(); ++k) {
        const DracoInput& attribute = attributes[k];
        if (attribute.elements.component != ComponentType::f32) continue;
        if (attribute.grid)
            encoder.SetAttributeExplicitQuantization(ids[k], attribute.bits, static_cast<int>(attribute.elements.components),
                                                     attribute.grid->origin.data(), attribute.grid->range);
        else
            encoder.SetAttributeQuantization(ids[k], attribute.bits);
    }
    encoder.SetTrackEncodedProperties(true);
    draco::EncoderBuffer buffer;
    if (const draco::Status status = encoder.EncodeToBuffer(&buffer); !status.ok())
        bad_gltf(where, std::string("Draco does not take it: ") + status.error_msg());
    const auto* first = reinterpret_cast<const std::uint8_t*>(buffer.data());
    stream.bytes.assign(first, first + buffer.size());
    stream.vertex_count = encoder.num_encoded_points();
    return stream;
}

Bytes encode_meshopt_vertices(ByteView bytes, std::size_t stride) {
    const std::size_t count = bytes.size() / stride;
    return encode_into(meshopt_encodeVertexBufferBound(count, stride), [&](std::uint8_t* data, std::size_t size) {
        return meshopt_encodeVertexBuffer(data, size, bytes.data(), count, stride);
    });
}

Bytes encode_meshopt_triangles(std::span<const std::uint32_t> indices) {
    use_index_version();
    return encode_into(meshopt_encodeIndexBufferBound(indices.size(), vertex_bound(indices)),
                       [&](std::uint8_t* data, std::size_t size) {
                           return meshopt_encodeIndexBuffer(data, size, indices.data(), indices.size());
                       });
}

Bytes encode_meshopt_sequence(std::span<const std::uint32_t> indices) {
    use_index_version();
    return encode_into(meshopt_encodeIndexSequenceBound(indices.size(), vertex_bound(indices)),
                       [&](std::uint8_t* data, std::size_t size) {
                           return meshopt_encodeIndexSequence(data, size, indices.data(), indices.size());
                       });
}

}  // namespace luxel
