/// Any bytes as a Draco stream: the first three say what the accessors of the primitive promise, the rest is the stream. What is decoded keeps
/// those promises, everything else is refused as bad input.
#include <array>
#include <cstddef>
#include <cstdlib>

#include "formats/gltf/gltf_compression.h"

namespace {

using namespace luxel;

void require(bool holds) {
    if (!holds) std::abort();
}

constexpr std::array<ComponentType, 6> components{ComponentType::i8, ComponentType::u8, ComponentType::i16, ComponentType::u16, ComponentType::u32, ComponentType::f32};
constexpr std::array<const char*, 4> types{"SCALAR", "VEC2", "VEC3", "VEC4"};

/// An attribute for a number of vertices: kind and width from a byte. The seed's POSITION is byte 0b10'101: VEC3 of f32.
DracoAttribute attribute(const char* semantic, std::uint32_t id, std::uint8_t byte, std::uint64_t count) {
    DracoAttribute wanted;
    wanted.semantic = semantic;
    wanted.unique_id = id;
    wanted.layout.component = components[byte % 8 % components.size()];
    wanted.layout.components = 1 + byte / 8 % 4;
    wanted.layout.type = types[wanted.layout.components - 1];
    wanted.layout.count = count;
    return wanted;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size < 3) return 0;
    const std::uint64_t count = data[2];
    const std::vector<DracoAttribute> wanted{attribute("POSITION", 0, data[0], count), attribute("TEXCOORD_0", 1 + data[1] / 32, data[1], count)};
    try {
        const DracoMesh mesh = decode_draco({data + 3, size - 3}, {wanted.data(), wanted.data() + (data[1] == 255 ? 1 : 2)}, "fuzz");
        require(mesh.indices.size() % 3 == 0);
        for (const std::uint32_t index : mesh.indices) require(index < mesh.vertex_count);
        for (const auto& [semantic, elements] : mesh.attributes)
            require(elements.count == count && mesh.vertex_count == count && elements.data.size() == count * elements.element_bytes());
    } catch (const Error& error) {
        require(error.code == ErrorCode::bad_input);
    }
    return 0;
}
