// The list of pages: every member of the schema, the same bytes twice, and failures that leave nothing behind.
#include "baker/output/sidecar.h"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "formats/base/error.h"

namespace luxel {
namespace {

Sidecar example() {
    Sidecar sidecar;
    sidecar.generator = "luxel 0.1.0";
    sidecar.model = "my hall.glb";
    sidecar.texels_per_metre = 16;
    sidecar.profile = "plain";
    SidecarPage page;
    page.width = 1024;
    page.height = 512;
    page.exr = {"my hall.lightmap0.exr", "", "linear", 1};
    page.picture = {"", "lightmap0.srgb8", "srgb8", 41.25, "png8", 0, PictureError{0.25, 0.5, 0.125}};
    sidecar.pages = {page, page};
    return sidecar;
}

TEST(Sidecar, SaysWhatIsThere) {
    const Bytes text = sidecar_text(example());
    EXPECT_EQ(text, sidecar_text(example()));
    const auto json = nlohmann::json::parse(text.begin(), text.end());
    EXPECT_EQ(json["schema"], 1);
    EXPECT_EQ(json["generator"], "luxel 0.1.0");
    EXPECT_EQ(json["model"], "my hall.glb");
    EXPECT_EQ(json["texCoord"], 1);
    EXPECT_EQ(json["texelsPerMetre"], 16.0);
    ASSERT_EQ(json["pages"].size(), 2u);
    const auto& page = json["pages"][1];
    EXPECT_EQ(page["index"], 1);
    EXPECT_EQ(page["width"], 1024);
    EXPECT_EQ(page["height"], 512);
    EXPECT_EQ(page["quantity"], "irradiance");
    EXPECT_EQ(page["unit"], "lux");
    EXPECT_EQ(page["exr"]["uri"], "my%20hall.lightmap0.exr");
    EXPECT_EQ(page["exr"]["encoding"], "linear");
    EXPECT_EQ(page["exr"]["intensity"], 1.0);
    EXPECT_FALSE(page["exr"].contains("name"));
    EXPECT_EQ(page["picture"], nlohmann::json::parse(R"({"name": "lightmap0.srgb8", "format": "png8", "encoding": "srgb8", "intensity": 41.25,
                                                         "error": {"median": 0.25, "p95": 0.5, "largest": 0.125}})"));
    EXPECT_EQ(page["png"], page["picture"]) << "for readers of the time when all pictures were PNG";
    EXPECT_EQ(json["profile"], "plain");
}

TEST(Sidecar, PicturesOfOtherKinds) {
    Sidecar sidecar = example();
    sidecar.pages[0].picture = {"a b.lightmap0.hdr", "lightmap0.rgbe8", "rgbe8", 2, "rgbe", 0, {}};
    sidecar.pages[1].picture = {"", "lightmap1.rgbm8", "rgbm8", 3, "rgbm", 8, {}};
    const Bytes text = sidecar_text(sidecar);
    const auto json = nlohmann::json::parse(text.begin(), text.end());
    EXPECT_EQ(json["pages"][0]["picture"], nlohmann::json::parse(R"({"name": "lightmap0.rgbe8", "uri": "a%20b.lightmap0.hdr", "format": "rgbe",
                                                                     "encoding": "rgbe8", "intensity": 2.0})"));
    EXPECT_FALSE(json["pages"][0].contains("png"));
    EXPECT_EQ(json["pages"][1]["picture"]["range"], 8.0);
    EXPECT_TRUE(json["pages"][1].contains("png"));
}

TEST(Sidecar, ListsLayers) {
    Sidecar sidecar = example();
    sidecar.pages[1].layer_file = "my hall.aov1.exr";
    sidecar.pages[1].layers = {Layer::direct, Layer::valid};
    const Bytes text = sidecar_text(sidecar);
    const auto json = nlohmann::json::parse(text.begin(), text.end());
    EXPECT_FALSE(json["pages"][0].contains("layers"));
    const auto& layers = json["pages"][1]["layers"];
    EXPECT_EQ(layers["uri"], "my%20hall.aov1.exr");
    ASSERT_EQ(layers["parts"].size(), 2u);
    EXPECT_EQ(layers["parts"][0], nlohmann::json::parse(R"({"name": "direct", "channels": "RGB", "quantity": "irradiance", "unit": "lux"})"));
    EXPECT_EQ(layers["parts"][1], nlohmann::json::parse(R"({"name": "valid", "channels": "Y", "quantity": "state of the texel"})"));
}

TEST(Sidecar, OnlyWhatIsNotFinalHasAState) {
    Sidecar preview = example();
    const Bytes final_text = sidecar_text(preview);
    EXPECT_FALSE(nlohmann::json::parse(final_text.begin(), final_text.end()).contains("state"));
    preview.state = "preview";
    const Bytes text = sidecar_text(preview);
    EXPECT_EQ(nlohmann::json::parse(text.begin(), text.end())["state"], "preview");
}

TEST(Sidecar, NamesAndBrokenText) {
    EXPECT_EQ(sidecar_path("out/hall.glb"), "out/hall.glb.lightmaps.json");
    Sidecar broken = example();
    broken.model = "h\xff.glb";
    EXPECT_NO_THROW((void)sidecar_text(broken));
    broken.pages[0].exr = {};
    const Bytes text = sidecar_text(broken);
    EXPECT_FALSE(nlohmann::json::parse(text.begin(), text.end())["pages"][0].contains("exr"));
}

TEST(Sidecar, IsPublishedWholeOrNotAtAll) {
    const auto folder = std::filesystem::path(testing::TempDir()) / "luxel_sidecar_test";
    std::filesystem::remove_all(folder);
    std::filesystem::create_directories(folder / "taken");
    write_sidecar(folder / "a.json", example());
    EXPECT_EQ(std::filesystem::file_size(folder / "a.json"), sidecar_text(example()).size());
    EXPECT_THROW(write_sidecar(folder / "taken", example()), Error);
    EXPECT_THROW(write_sidecar(folder / "missing" / "a.json", example()), Error);
    std::size_t files = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) files += entry.is_regular_file();
    EXPECT_EQ(files, 1u);
    std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace luxel
