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

}  // namespace
}  // namespace luxel
