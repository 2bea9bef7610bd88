#include "formats/gltf/gltf_document.h"

#include <algorithm>
#include <array>
#include <set>

#include "formats/base/file.h"
#include "formats/gltf/gltf_compression.h"
#include "formats/gltf/gltf_json.h"
#include "formats/gltf/gltf_uri.h"

namespace luxel {

using nlohmann::json;

namespace {

constexpr std::uint32_t glb_magic = 0x46546c67;   // "glTF"
constexpr std::uint32_t chunk_json = 0x4e4f534a;  // "JSON"
constexpr std::uint32_t chunk_bin = 0x004e4942;   // "BIN\0"

const std::string damaged_hint = "the file is damaged or was cut off; export or copy it again";

std::uint32_t u32_at(ByteView bytes, std::size_t offset) {
    std::uint32_t value;
    std::memcpy(&value, bytes.data() + offset, sizeof value);
    return value;
}

struct Container {
    ByteView text;                 ///< JSON
    std::optional<ByteView> body;  ///< BIN chunk
};

/// Source: glTF 2.0, section 4.4: header of 12 bytes, chunks of length, type, data; unknown chunks are skipped.
Container open_glb(ByteView bytes, const std::string& name) {
    if (bytes.size() < 12) bad_gltf(name, "GLB header: expected 12 bytes, found " + std::to_string(bytes.size()), damaged_hint);
    if (u32_at(bytes, 4) != 2)
        bad_gltf(name, "GLB version: expected 2, found " + std::to_string(u32_at(bytes, 4)), "export the scene as glTF 2.0");
    const std::size_t length = u32_at(bytes, 8);
    if (length > bytes.size())
        bad_gltf(name, "GLB length: header says " + std::to_string(length) + " bytes, found " + std::to_string(bytes.size()),
                 damaged_hint);
    if (length < 20) bad_gltf(name, "GLB length: expected at least 20 bytes, header says " + std::to_string(length), damaged_hint);

    Container found;
    bool first = true;
    for (std::size_t at = 12; at < length; first = false) {
        if (length - at < 8)
            bad_gltf(name, "GLB chunk header at byte " + std::to_string(at) + ": expected 8 bytes, found " +
                               std::to_string(length - at), damaged_hint);
        const std::size_t size = u32_at(bytes, at);
        const std::uint32_t type = u32_at(bytes, at + 4);
        at += 8;
        if (size > length - at)
            bad_gltf(name, "GLB chunk at byte " + std::to_string(at - 8) + ": says " + std::to_string(size) +
                               " bytes, but only " + std::to_string(length - at) + " are left", damaged_hint);
        const ByteView data = bytes.subspan(at, size);
        if (first) {
            if (type != chunk_json) bad_gltf(name, "GLB: the first chunk is not JSON", damaged_hint);
            found.text = data;
        } else if (type == chunk_bin && !found.body) {
            found.body = data;
        }
        // Chunks start at multiples of 4; a last chunk without its padding is accepted.
        at = std::min(length, (at + size + 3) / 4 * 4);
    }
    return found;
}

void check_version(const json& root, const std::string& name) {
    if (!root.contains("asset")) bad_gltf(name, "\"asset\" is missing: this is not a glTF file");
    const json& asset = json_object(root, "asset", name);
    const std::string version = json_text(asset, "version", "", name + ": asset");
    if (version.rfind("2.", 0) != 0)
        bad_gltf(name, "asset.version: expected 2.x, found \"" + version + "\"", "export the scene as glTF 2.0");
    const std::string least = json_text(asset, "minVersion", "2.0", name + ": asset");
    if (least != "2.0")
        bad_gltf(name, "asset.minVersion: this program reads 2.0, the file needs \"" + least + "\"");
}

/// Extensions that may be required: read, or ignored without harm to surfaces and light.
bool is_known_extension(const std::string& name) {
    static const std::set<std::string> known{
        "KHR_mesh_quantization", "KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_meshopt_compression",
        "KHR_texture_transform", "KHR_lights_punctual", "EXT_lights_image_based", "EXT_mesh_gpu_instancing", "KHR_texture_basisu",
        "EXT_texture_webp", "MOZ_lightmap", "MX_lightmap", "KHR_xmp_json_ld", "KHR_materials_anisotropy", "KHR_materials_clearcoat",
        "KHR_materials_diffuse_transmission", "KHR_materials_dispersion", "KHR_materials_emissive_strength", "KHR_materials_ior",
        "KHR_materials_iridescence", "KHR_materials_pbrSpecularGlossiness", "KHR_materials_sheen", "KHR_materials_specular",
        "KHR_materials_transmission", "KHR_materials_unlit", "KHR_materials_variants", "KHR_materials_volume",
        "KHR_materials_volume_scatter"};
    return known.contains(name);
}

void check_extensions(GltfDocument& document) {
    const auto names = [&](const char* list) {
        std::vector<std::string> found;
        for (const json& item : json_array(document.json, list, document.name)) {
            if (!item.is_string()) bad_gltf(document.name, std::string(list) + ": expected texts, found " + item.type_name());
            found.push_back(item.get<std::string>());
        }
        return found;
    };
    for (const std::string& name : names("extensionsRequired"))
        if (!is_known_extension(name))
            bad_gltf(document.name, "the file requires the extension " + name + ", which this program does not know",
                     "export the scene without it");
    for (const std::string& name : names("extensionsUsed"))
        if (!is_known_extension(name))
            document.warnings.push_back({"unknown-extension", document.name, name + " is kept in the file, but ignored"});
}

/// Buffers whose data only a decoder without meshopt would need.
bool is_fallback_buffer(const json& buffer, const std::string& where) {
    for (const char* key : {"EXT_meshopt_compression", "KHR_meshopt_compression"})
        if (const json* extension = json_extension(buffer, key, where))
            if (json_bool(*extension, "fallback", false, where)) return true;
    return false;
}

void load_buffers(GltfDocument& document, std::optional<ByteView> body) {
    const std::size_t count = json_array(document.json, "buffers", document.name).size();
    for (std::size_t i = 0; i < count; ++i) {
        const std::string where = document.name + ": buffer " + std::to_string(i);
        const json& buffer = gltf_item(document.json, "buffers", static_cast<std::int64_t>(i), document.name);
        const std::uint64_t length = json_size_required(buffer, "byteLength", where);
        const bool fallback = is_fallback_buffer(buffer, where);
        Bytes bytes;
        if (buffer.contains("uri")) {
            bytes = read_uri(document, json_text(buffer, "uri", "", where), where);
        } else if (i == 0 && body && !fallback) {
            bytes.assign(body->begin(), body->end());
        } else if (!fallback) {
            bad_gltf(where, "has neither a uri nor a GLB chunk", damaged_hint);
        }
        if (bytes.size() < length && !(fallback && bytes.empty()))
            bad_gltf(where, "byteLength says " + std::to_string(length) + " bytes, found " + std::to_string(bytes.size()),
                     damaged_hint);
        document.buffers.push_back(std::move(bytes));
    }
}

bool attribute_uses_view(const json& root, const json& accessor_index, std::int64_t view) {
    const json& accessors = json_array(root, "accessors", "accessors");
    if (!accessor_index.is_number_unsigned() || accessor_index.get<std::uint64_t>() >= accessors.size()) return false;
    const json& accessor = accessors[accessor_index.get<std::size_t>()];
    if (!accessor.is_object()) return false;
    const auto found = accessor.find("bufferView");
    return found != accessor.end() && *found == view;
}

/// `, used by mesh "Stairs" primitive 2`, or nothing: for the messages about a damaged view. Never throws.
std::string first_user_of_view(const json& root, std::int64_t view) {
    try {
        const json& meshes = json_array(root, "meshes", "meshes");
        for (std::size_t m = 0; m < meshes.size(); ++m) {
            const json& primitives = json_array(meshes[m], "primitives", "primitives");
            for (std::size_t p = 0; p < primitives.size(); ++p) {
                bool uses = primitives[p].contains("indices") && attribute_uses_view(root, primitives[p]["indices"], view);
                for (const json& attribute : json_object(primitives[p], "attributes", "attributes"))
                    uses = uses || attribute_uses_view(root, attribute, view);
                if (uses)
                    return ", used by " + gltf_name(meshes[m], "mesh", static_cast<std::int64_t>(m)) + " primitive " +
                           std::to_string(p);
            }
        }
    } catch (const Error&) {  // the view is damaged and so is this mesh: the first message is enough
    }
    return "";
}

void decode_views(GltfDocument& document) {
    const std::size_t count = json_array(document.json, "bufferViews", document.name).size();
    document.decoded_views.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
        const auto index = static_cast<std::int64_t>(i);
        const json& view = gltf_item(document.json, "bufferViews", index, document.name);
        const std::string where = document.name + ": bufferView " + std::to_string(i);
        if (const json* extension = meshopt_extension(view, where))
            document.decoded_views[i] =
                decode_meshopt_view(document, *extension, where + first_user_of_view(document.json, index));
    }
}

}  // namespace

ByteView GltfDocument::view(std::int64_t index, const std::string& where) const {
    const nlohmann::json& item = gltf_item(json, "bufferViews", index, where);
    const std::string here = where + ": bufferView " + std::to_string(index);
    const auto at = static_cast<std::size_t>(index);
    if (at < decoded_views.size() && decoded_views[at]) return *decoded_views[at];
    const std::int64_t buffer = json_index(item, "buffer", buffers.size(), here);
    if (buffer < 0) bad_gltf(here, "\"buffer\" is missing");
    const std::uint64_t offset = json_size(item, "byteOffset", 0, here);
    const std::uint64_t length = json_size_required(item, "byteLength", here);
    const Bytes& bytes = buffers[static_cast<std::size_t>(buffer)];
    if (offset > bytes.size() || length > bytes.size() - offset)
        bad_gltf(here, "needs bytes " + std::to_string(offset) + " to " + std::to_string(offset + length) + " of buffer " +
                           std::to_string(buffer) + ", which has " + std::to_string(bytes.size()), damaged_hint);
    return ByteView(bytes).subspan(offset, length);
}

std::uint64_t GltfDocument::view_stride(std::int64_t index) const {
    const nlohmann::json& item = gltf_item(json, "bufferViews", index, name);
    const std::string where = name + ": bufferView " + std::to_string(index);
    if (const nlohmann::json* extension = meshopt_extension(item, where))
        return json_size_required(*extension, "byteStride", where);
    const std::uint64_t stride = json_size(item, "byteStride", 0, where);
    if (stride && (stride < 4 || stride > 252))
        bad_gltf(where, "byteStride: expected 4 to 252, found " + std::to_string(stride));
    return stride;
}

GltfDocument parse_gltf(ByteView bytes, const std::string& name, const std::filesystem::path& folder, bool allow_outside) {
    GltfDocument document;
    document.name = name;
    document.folder = folder;
    document.allow_outside = allow_outside;
    document.binary = bytes.size() >= 4 && u32_at(bytes, 0) == glb_magic;
    if (bytes.empty()) bad_gltf(name, "the file is empty", damaged_hint);
    const Container container = document.binary ? open_glb(bytes, name) : Container{bytes, std::nullopt};
    document.json = parse_json_object(container.text, name, "luxel reads .gltf and .glb files; is this one of them?");
    check_version(document.json, name);
    check_extensions(document);
    load_buffers(document, container.body);
    decode_views(document);
    return document;
}

GltfDocument load_gltf(const std::filesystem::path& path, bool allow_outside) {
    return parse_gltf(read_file(path), path.filename().string(), path.parent_path(), allow_outside);
}

}  // namespace luxel
