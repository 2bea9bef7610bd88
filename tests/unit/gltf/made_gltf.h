/// Small glTF files made in memory, and the folder of real scenes beside the project.
#pragma once
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "formats/gltf/gltf_document.h"

namespace luxel::test {

/// Appends data to one buffer and describes it; `json` may be changed freely before glb() or document().
struct MadeGltf {
    nlohmann::json json = {{"asset", {{"version", "2.0"}}}};
    Bytes body;

    /// Index of a new buffer view.
    template <class T>
    std::size_t view(const std::vector<T>& values, std::size_t stride = 0) {
        while (body.size() % 4) body.push_back(0);
        nlohmann::json item = {{"buffer", 0}, {"byteOffset", body.size()}, {"byteLength", values.size() * sizeof(T)}};
        if (stride) item["byteStride"] = stride;
        const ByteView bytes = bytes_of(values);
        body.insert(body.end(), bytes.begin(), bytes.end());
        json["bufferViews"].push_back(item);
        return json["bufferViews"].size() - 1;
    }
    std::size_t accessor(std::size_t buffer_view, int component, const std::string& type, std::size_t count) {
        json["accessors"].push_back({{"bufferView", buffer_view}, {"componentType", component}, {"type", type}, {"count", count}});
        return json["accessors"].size() - 1;
    }
    template <class T>
    std::size_t array(const std::vector<T>& values, int component, const std::string& type, std::size_t count) {
        return accessor(view(values), component, type, count);
    }
    /// A node in the default scene with one mesh of one primitive; returns the primitive, to be filled.
    nlohmann::json& primitive(std::size_t positions) {
        json["meshes"].push_back({{"name", "m"}, {"primitives", {{{"attributes", {{"POSITION", positions}}}}}}});
        json["nodes"].push_back({{"name", "n"}, {"mesh", json["meshes"].size() - 1}});
        json["scene"] = 0;
        if (!json.contains("scenes")) json["scenes"] = {{{"nodes", nlohmann::json::array()}}};
        json["scenes"][0]["nodes"].push_back(json["nodes"].size() - 1);
        return json["meshes"].back()["primitives"][0];
    }
    /// The unit square in z = 0 as four corners.
    std::size_t square() {
        return array(std::vector<float>{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}, 5126, "VEC3", 4);
    }
    [[nodiscard]] Bytes glb() const {
        nlohmann::json whole = json;
        Bytes padded = body;
        while (padded.size() % 4) padded.push_back(0);
        if (!body.empty()) whole["buffers"] = {{{"byteLength", body.size()}}};
        std::string text = whole.dump();
        text.append((4 - text.size() % 4) % 4, ' ');
        ByteWriter out;
        const auto u32 = [&](std::size_t value) { out.put(static_cast<std::uint32_t>(value)); };
        u32(0x46546c67);
        u32(2);
        u32(20 + text.size() + (body.empty() ? 0 : 8 + padded.size()));
        u32(text.size());
        u32(0x4e4f534a);
        out.put_array(std::span<const char>(text.data(), text.size()));
        if (!body.empty()) {
            u32(padded.size());
            u32(0x004e4942);
            out.put_array(std::span<const std::uint8_t>(padded));
        }
        return out.take();
    }
    [[nodiscard]] GltfDocument document() const { return parse_gltf(glb(), "made.glb", "."); }
};

/// Folder of real scenes: LUXEL_SCENES, else "../shared/scenes" beside the sources. Need not exist.
inline std::filesystem::path scenes_folder() {
    if (const char* folder = std::getenv("LUXEL_SCENES")) return folder;
    const char* source = std::getenv("LUXEL_SOURCE_DIR");
    return std::filesystem::path(source ? source : ".") / ".." / "shared" / "scenes";
}

/// The message of the Error{bad_input} that `action` throws; empty if it throws none.
template <class Action>
std::string bad_input_of(const Action& action) {
    try {
        action();
    } catch (const Error& error) {
        return error.code == ErrorCode::bad_input ? error.what() : std::string("wrong code: ") + error.what();
    }
    return "";
}

}  // namespace luxel::test
