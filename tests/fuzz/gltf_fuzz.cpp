/// Any bytes as a glTF file: the reader answers with a scene or with Error{bad_input}, nothing else, and what it gives
/// keeps the promises of scene_record.h. External files are out of reach: the folder does not exist.
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "baker/scene/scene_build.h"
#include "formats/gltf/gltf_in.h"

namespace {

void require(bool holds) {
    if (!holds) std::abort();
}

void check_record(const luxel::SceneRecord& record) {
    for (const auto& mesh : record.meshes)
        for (const auto& primitive : mesh.primitives) {
            const std::size_t count = primitive.positions.size();
            require(primitive.indices.size() % 3 == 0);
            for (const std::uint32_t index : primitive.indices) require(index < count);
            require(primitive.normals.empty() || primitive.normals.size() == count);
            for (const auto& uv : primitive.uv) require(uv.empty() || uv.size() == count);
        }
    for (const auto& instance : record.instances)
        require(instance.mesh >= 0 && static_cast<std::size_t>(instance.mesh) < record.meshes.size());
}

/// An image of up to 4 by 4 pixels made of the first bytes: textures are looked up without an image library.
std::optional<luxel::DecodedImage> decode(luxel::ByteView bytes, const std::string&) {
    if (bytes.empty()) return std::nullopt;
    luxel::DecodedImage image{1u + bytes[0] % 4, 1u + bytes[0] / 4 % 4, {}};
    for (std::uint32_t k = 0; k < image.width * image.height; ++k)
        image.rgba.push_back({static_cast<float>(bytes[k % bytes.size()]) / 255, 0.5f, 0, 1});
    return image;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    try {
        const luxel::SceneRecord record = luxel::read_scene(luxel::parse_gltf({data, size}, "fuzz", "/nonexistent"));
        check_record(record);
        std::vector<luxel::Warning> warnings;
        luxel::build_scene(record, decode, {}, warnings);
    } catch (const luxel::Error& error) {
        require(error.code == luxel::ErrorCode::bad_input);
    }
    return 0;
}
