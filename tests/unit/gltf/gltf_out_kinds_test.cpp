// Pictures of pages that glTF does not know, and what materials say of pages for different viewers.
#include <gtest/gtest.h>

#include "formats/base/file.h"
#include "formats/gltf/gltf_out.h"
#include "tests/unit/gltf/made_gltf_out.h"

namespace luxel {
namespace {

struct Written {
    GltfDocument document;
    GltfWritten files;
};

class GltfOutKinds : public GltfOut {
  protected:
    /// A quad of a lit material and one of an unlit one.
    Written write(const char* name, const LightmapMeaning& meaning) {
        Model model;
        model.root["materials"] = json::array({json::object(), {{"extensions", {{"KHR_materials_unlit", json::object()}}}}});
        model.root["meshes"] = json::array({{{"primitives", json::array({model.quad(0), model.quad(1)})}}});
        model.show(0, "n");
        const GltfDocument document = model.parse();
        const SceneRecord record = read_scene(document);
        GltfLightmaps maps = lightmaps(record);
        maps.pages[0].file = {'#', '?', 'R', 'A', 'D', 'I', 'A', 'N', 'C', 'E', '\n'};
        maps.meaning = meaning;
        MeshLayout layout;
        for (const PrimitiveRecord& primitive : record.meshes[0].primitives) layout.push_back(welded(primitive));
        maps.instances[0] = laid_out(std::move(layout));
        GltfWritten files = write_gltf(folder / name, document, record, maps);
        return {load_gltf(folder / name), std::move(files)};
    }
    static LightmapMeaning radiance() {
        LightmapMeaning meaning;
        meaning.encoding = "rgbe8", meaning.format = "rgbe";
        meaning.suffix = ".hdr", meaning.mime_type = "image/vnd.radiance", meaning.texture_extension = "MOZ_texture_rgbe";
        meaning.is_embedded = false;
        return meaning;
    }
    static const json& lightmap(const GltfDocument& out, std::size_t primitive) {
        const auto material = out.json["meshes"][0]["primitives"][primitive]["material"].get<std::size_t>();
        return out.json["materials"][material]["extensions"]["MOZ_lightmap"];
    }
};

TEST_F(GltfOutKinds, ForeignPicturesLieBesideTheModel) {
    for (const char* name : {"a b.glb", "a b.gltf"}) {
        const auto [out, files] = write(name, radiance());
        const json& image = out.json["images"][0];
        EXPECT_EQ(image, (json{{"name", "lightmap0"}, {"uri", "a%20b.lightmap0.hdr"}, {"extensions", {{"MOZ_texture_rgbe", json::object()}}}}));
        EXPECT_EQ(out.json["textures"][0]["extensions"], (json{{"MOZ_texture_rgbe", {{"source", 0}}}}));
        EXPECT_FALSE(out.json["textures"][0].contains("source"));
        EXPECT_EQ(out.json["extensionsUsed"], (json{"MOZ_texture_rgbe", "MOZ_lightmap"}));
        EXPECT_FALSE(out.json.contains("extensionsRequired"));
        EXPECT_EQ(files.page_files, std::vector<std::string>{"a b.lightmap0.hdr"});
        EXPECT_EQ(read_file(folder / "a b.lightmap0.hdr").size(), 11u);
        EXPECT_EQ(files.files[0], folder / name);
    }
}

TEST_F(GltfOutKinds, OrInsideAGlbWhereTheProfileWantsThat) {
    LightmapMeaning meaning = radiance();
    meaning.is_embedded = true;
    const auto [out, files] = write("out.glb", meaning);
    EXPECT_EQ(out.json["images"][0]["mimeType"], "image/vnd.radiance");
    EXPECT_EQ(out.view(out.json["images"][0]["bufferView"].get<std::int64_t>(), "hdr").size(), 11u);
    EXPECT_EQ(files.page_files, std::vector<std::string>{""});
    EXPECT_EQ(file_count(), 1u);
}

TEST_F(GltfOutKinds, ScalesAndWhatTheyMean) {
    LightmapMeaning meaning;
    meaning.profile = "some", meaning.range = 8, meaning.unlit_scale = 0.25;
    const auto [out, files] = write("out.glb", meaning);
    EXPECT_EQ(lightmap(out, 0)["intensity"], 2.5);
    EXPECT_EQ(lightmap(out, 1)["intensity"], 0.625);
    EXPECT_EQ(lightmap(out, 0)["extras"]["irradianceFactor"], 1.0);
    EXPECT_EQ(lightmap(out, 1)["extras"]["irradianceFactor"], 4.0);
    EXPECT_EQ(lightmap(out, 1)["extras"]["range"], 8.0);
    EXPECT_EQ(lightmap(out, 1)["extras"]["profile"], "some");
}

TEST_F(GltfOutKinds, UnlitMaterialsShowTheirPage) {
    Model model;
    model.root["materials"] = json::parse(R"([
        {"name": "leaf", "extras": 7, "doubleSided": true, "alphaMode": "MASK", "alphaCutoff": 0.2, "emissiveFactor": [1, 1, 1],
         "pbrMetallicRoughness": {"baseColorFactor": [1, 0, 0, 1], "metallicFactor": 1}},
        {"name": "pane", "alphaMode": "OPAQUE", "extensions": {"KHR_materials_transmission": {"transmissionFactor": 0.75},
                                                               "MOZ_lightmap": {"index": 0, "intensity": 3}}}])");
    model.root["meshes"] = json::array({{{"primitives", json::array({model.quad(0), model.quad(1), model.quad(0)})}}});
    model.show(0, "n");
    const GltfDocument document = model.parse();
    const SceneRecord record = read_scene(document);
    GltfLightmaps pages = lightmaps(record);
    pages.is_unlit = true;
    MeshLayout layout;
    for (std::size_t p = 0; p < 3; ++p) {
        const PrimitiveRecord& primitive = record.meshes[0].primitives[p];
        layout.push_back(p < 2 ? welded(primitive) : scattered(primitive, [](std::size_t) { return no_page; }));
    }
    pages.instances[0] = laid_out(std::move(layout));
    const GltfDocument out = write_and_load(document, record, pages);
    const auto material = [&](std::size_t primitive) {
        return out.json["materials"][out.json["meshes"][0]["primitives"][primitive]["material"].get<std::size_t>()];
    };
    EXPECT_EQ(material(0), json::parse(R"({"name": "leaf", "extras": 7, "doubleSided": true, "alphaMode": "MASK", "extensions": {"KHR_materials_unlit": {}},
        "pbrMetallicRoughness": {"baseColorTexture": {"index": 0, "texCoord": 1}, "metallicFactor": 0.0, "roughnessFactor": 1.0}})"));
    EXPECT_EQ(material(1)["alphaMode"], "BLEND");
    EXPECT_EQ(material(1)["pbrMetallicRoughness"]["baseColorFactor"], (json{1.0, 1.0, 1.0, 0.25}));
    EXPECT_EQ(material(1)["extensions"], json::parse(R"({"KHR_materials_unlit": {}})"));
    EXPECT_EQ(material(2), document.json["materials"][0]) << "without a page it stays what it was";
    EXPECT_EQ(out.json["extensionsUsed"], json{"KHR_materials_unlit"});
}

TEST_F(GltfOutKinds, UnlitCopiesHaveTheirPlaces) {
    Model model;
    model.root["materials"] = json::array({json::object()});
    model.root["meshes"] = json::array({{{"primitives", json::array({model.quad()})}}});
    model.show(0, "n");
    const GltfDocument document = model.parse();
    const SceneRecord record = read_scene(document);
    GltfLightmaps pages = lightmaps(record);
    pages.is_unlit = true;
    pages.instances[0] = laid_out({welded(record.meshes[0].primitives[0])}, {{0.5f, 0.25f}, {0.125f, 0}});
    const json out = write_and_load(document, record, pages).json;
    const json& use = out["materials"][out["meshes"][0]["primitives"][0]["material"].get<std::size_t>()]["pbrMetallicRoughness"]["baseColorTexture"];
    EXPECT_EQ(use["extensions"]["KHR_texture_transform"], (json{{"offset", {0.125, 0.0}}, {"scale", {0.5, 0.25}}}));
}

TEST_F(GltfOutKinds, UnlitModelsLeaveOutWhatNothingShows) {
    const auto model_with = [](int shown) {
        Model model;
        model.root["images"] = json::array({{{"uri", "data:image/png;base64,iVBORw0KGgoAAAA="}}, {{"uri", "gone.png"}}});
        model.root["samplers"] = json::array({json::object()});
        model.root["textures"] = json::array({{{"source", 0}, {"sampler", 0}}, {{"source", 1}}});
        model.root["materials"] = json::parse(R"([{"name": "a", "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}},
            {"name": "b", "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 3}}}])");
        model.root["extensionsUsed"] = {"KHR_materials_emissive_strength", "KHR_mesh_quantization"};
        model.root["meshes"] = json::array({{{"primitives", json::array({model.quad(0), model.quad(1), model.quad(0)})}}});
        if (shown < 0) model.root["meshes"][0]["primitives"].erase(2);
        model.show(0, "n");
        return model.parse();
    };
    for (const int shown : {-1, 2}) {
        const GltfDocument document = model_with(shown);
        const SceneRecord record = read_scene(document);
        GltfLightmaps pages = lightmaps(record, 2);
        pages.is_unlit = true;
        const auto& primitives = record.meshes[0].primitives;
        MeshLayout layout{scattered(primitives[0], [](std::size_t t) { return static_cast<std::uint32_t>(t); }), welded(primitives[1])};
        if (shown > 0) layout.push_back(scattered(primitives[2], [](std::size_t) { return no_page; }));
        pages.instances[0] = laid_out(std::move(layout));
        const json out = write_and_load(document, record, pages).json;
        if (shown > 0) {
            EXPECT_EQ(out["materials"].size(), 5u) << "the third primitive still shows one of the input";
            EXPECT_EQ(out["images"].size(), 4u);
            continue;
        }
        EXPECT_EQ(out["images"].size(), 2u);
        EXPECT_EQ(out["samplers"].size(), 1u);
        ASSERT_EQ(out["textures"].size(), 2u);
        ASSERT_EQ(out["materials"].size(), 3u) << "a on two pages, b on one";
        std::vector<std::string> shows;
        for (const json& primitive : out["meshes"][0]["primitives"]) {
            const json& material = out["materials"].at(primitive["material"].get<std::size_t>());
            const json& texture = out["textures"].at(material["pbrMetallicRoughness"]["baseColorTexture"]["index"].get<std::size_t>());
            shows.push_back(material["name"].get<std::string>() + " " + out["images"].at(texture["source"].get<std::size_t>())["name"].get<std::string>());
            EXPECT_EQ(texture["sampler"], 0);
        }
        EXPECT_EQ(shows, (std::vector<std::string>{"a lightmap0", "a lightmap1", "b lightmap0"}));
        EXPECT_EQ(out["extensionsUsed"], (json{"KHR_mesh_quantization", "KHR_materials_unlit"}));
        EXPECT_TRUE(written.warnings.empty()) << "the missing picture is not missed";
    }
}

}  // namespace
}  // namespace luxel
