/// What the tests of gltf_out share: small models made by hand, layouts for them, and a folder to write into.
#pragma once
#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "formats/gltf/gltf_in.h"
#include "formats/gltf/gltf_out.h"
#include "formats/gltf/gltf_primitive.h"

namespace luxel {

using nlohmann::json;

/// A document put together array by array; its buffer is a data URI.
class Model {
  public:
    json root = {{"asset", {{"version", "2.0"}, {"generator", "test tool"}}}};

    template <class T>
    std::size_t array(const char* type, int component, std::uint64_t components, const std::vector<T>& values,
                      bool normalized = false, std::size_t stride = 0) {
        while (body_.size() % 4) body_.push_back(0);
        const std::size_t offset = body_.size(), element = components * sizeof(T), count = values.size() / components;
        if (!stride) stride = element;
        for (std::size_t k = 0; k < count; ++k) {
            const auto* first = reinterpret_cast<const std::uint8_t*>(values.data()) + k * element;
            body_.insert(body_.end(), first, first + element);
            body_.insert(body_.end(), stride - element, 0);
        }
        json view = {{"buffer", 0}, {"byteOffset", offset}, {"byteLength", body_.size() - offset}};
        if (stride != element) view["byteStride"] = stride;
        root["bufferViews"].push_back(view);
        json accessor = {{"bufferView", root["bufferViews"].size() - 1},
                         {"componentType", component},
                         {"count", count},
                         {"type", type}};
        if (normalized) accessor["normalized"] = true;
        root["accessors"].push_back(accessor);
        return root["accessors"].size() - 1;
    }
    std::size_t floats(const char* type, std::uint64_t components, const std::vector<float>& values) {
        return array(type, 5126, components, values);
    }
    std::size_t indices(const std::vector<std::uint16_t>& values) { return array("SCALAR", 5123, 1, values); }

    /// A quad of two triangles over the unit square, as mesh with one primitive.
    json quad(int material = 0) {
        const std::size_t positions = floats("VEC3", 3, {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0});
        return {{"attributes", {{"POSITION", positions}}},
                {"indices", indices({0, 1, 2, 0, 2, 3})},
                {"material", material}};
    }
    void show(std::size_t mesh, const char* name) {
        root["nodes"].push_back({{"mesh", mesh}, {"name", name}});
        root["scenes"] = json::array({{{"nodes", json::array()}}});
        for (std::size_t node = 0; node < root["nodes"].size(); ++node) root["scenes"][0]["nodes"].push_back(node);
        root["scene"] = 0;
    }
    [[nodiscard]] GltfDocument parse(const std::filesystem::path& folder = {}) const {
        json copy = root;
        if (!body_.empty())
            copy["buffers"] = json::array(
                {{{"byteLength", body_.size()}, {"uri", "data:application/octet-stream;base64," + base64(body_)}}});
        const std::string text = copy.dump();
        return parse_gltf({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}, "test.gltf", folder);
    }

  private:
    static std::string base64(const Bytes& bytes) {
        constexpr const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
        std::string text;
        for (std::size_t k = 0; k < bytes.size(); k += 3) {
            std::uint32_t bits = 0;
            for (std::size_t j = 0; j < 3; ++j) bits = (bits << 8) | (k + j < bytes.size() ? bytes[k + j] : 0u);
            for (std::size_t j = 0; j < 4; ++j)
                text += k + j > bytes.size() ? '=' : digits[(bits >> (18 - 6 * j)) & 63];
        }
        return text;
    }
    Bytes body_;
};

inline const Bytes fake_png = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n', 1, 2, 3};

/// Every triangle on a place of its own, on page `page_of(triangle)`.
template <class PageOf>
PrimitiveLayout scattered(const PrimitiveRecord& primitive, const PageOf& page_of) {
    PrimitiveLayout layout;
    for (std::size_t t = 0; t < primitive.indices.size() / 3; ++t) {
        layout.triangle_page.push_back(page_of(t));
        for (std::size_t c = 0; c < 3; ++c)
            layout.corner_uv.emplace_back(static_cast<float>(t + 1) / 64.0f, static_cast<float>(c + 1) / 8.0f);
    }
    return layout;
}
inline PrimitiveLayout scattered(const PrimitiveRecord& primitive) {
    return scattered(primitive, [](std::size_t) { return 0u; });
}

/// All corners of one old vertex at the same place.
inline PrimitiveLayout welded(const PrimitiveRecord& primitive, float shift = 0) {
    PrimitiveLayout layout;
    layout.triangle_page.assign(primitive.indices.size() / 3, 0);
    for (const std::uint32_t vertex : primitive.indices)
        layout.corner_uv.emplace_back(static_cast<float>(vertex) / 16.0f + shift, 0.25f);
    return layout;
}

inline InstanceLayout laid_out(MeshLayout layout, const LayoutPlace& place = {}) {
    return {std::make_shared<const MeshLayout>(std::move(layout)), place};
}

/// A layout of its own for every instance; layout(instance, primitive).
template <class Layout>
std::vector<InstanceLayout> laid_out_each(const SceneRecord& record, const Layout& layout) {
    std::vector<InstanceLayout> instances;
    for (std::size_t k = 0; k < record.instances.size(); ++k) {
        MeshLayout mesh;
        for (const PrimitiveRecord& primitive : record.meshes[static_cast<std::size_t>(record.instances[k].mesh)].primitives)
            mesh.push_back(layout(k, primitive));
        instances.push_back(laid_out(std::move(mesh)));
    }
    return instances;
}

inline GltfLightmaps lightmaps(const SceneRecord& record, std::size_t pages = 1) {
    GltfLightmaps maps;
    for (std::size_t page = 0; page < pages; ++page)
        maps.pages.push_back({"lightmap" + std::to_string(page), fake_png, 2.5 + static_cast<double>(page)});
    maps.instances.resize(record.instances.size());
    maps.version = "9.9.9";
    return maps;
}

/// Three copies of a node with one primitive: the first and the last share a layout on page 0, the second has its own on page 1.
inline std::vector<InstanceLayout> copies_on_two_pages(const SceneRecord& record) {
    PrimitiveLayout first = welded(record.meshes[0].primitives[0]), second = first;
    second.triangle_page.assign(second.triangle_page.size(), 1);
    std::vector<InstanceLayout> instances{laid_out({first}, {{0.5f, 0.5f}, {0, 0}}), laid_out({second}, {{0.5f, 0.5f}, {0.25f, 0}})};
    instances.push_back({instances[0].mesh, {{0.5f, 0.5f}, {0, 0.5f}}});
    return instances;
}

class GltfOut : public testing::Test {
  protected:
    void SetUp() override {
        const auto* test = testing::UnitTest::GetInstance()->current_test_info();
        folder = std::filesystem::path(testing::TempDir()) / ("luxel_gltf_out_" + std::string(test->name()));
        std::filesystem::remove_all(folder);
        std::filesystem::create_directories(folder);
    }
    void TearDown() override { std::filesystem::remove_all(folder); }
    [[nodiscard]] std::size_t file_count() const {
        std::size_t count = 0;
        for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
            count += entry.is_regular_file();
        return count;
    }
    GltfDocument write_and_load(const GltfDocument& document, const SceneRecord& record, const GltfLightmaps& maps) {
        written = write_gltf(folder / "out.glb", document, record, maps);
        return load_gltf(folder / "out.glb");
    }
    /// One layout kind for every primitive.
    template <class Layout>
    GltfDocument bake(const GltfDocument& document, const Layout& layout, std::size_t pages = 1) {
        const SceneRecord record = read_scene(document);
        GltfLightmaps maps = lightmaps(record, pages);
        maps.instances = laid_out_each(record, [&](std::size_t, const PrimitiveRecord& primitive) { return layout(primitive); });
        return write_and_load(document, record, maps);
    }
    std::filesystem::path folder;
    GltfWritten written;
};

/// The attribute of a primitive, corner by corner.
inline Bytes corners(const PrimitiveArrays& arrays, const std::string& semantic) {
    const AccessorBytes& elements = arrays.attributes.at(semantic);
    const std::uint64_t step = elements.element_bytes();
    Bytes out;
    for (const std::uint32_t vertex : triangle_list(arrays.mode, arrays.indices)) {
        const auto* first = elements.data.data() + vertex * step;
        out.insert(out.end(), first, first + step);
    }
    return out;
}

inline Bytes bytes_of_uv(const PrimitiveLayout& layout) {
    const ByteView view = bytes_of(layout.corner_uv);
    return {view.begin(), view.end()};
}

inline const auto scatter = [](const PrimitiveRecord& primitive) { return scattered(primitive); };
inline const auto weld = [](const PrimitiveRecord& primitive) { return welded(primitive); };

}  // namespace luxel
