// Bakes of common pictures do not load the module for the rarer kinds, neither for textures nor for skies nor for lightmaps.
#include <gtest/gtest.h>

#include <algorithm>
#include <string_view>

#include "formats/base/file.h"
#include "formats/image/image_file.h"
#include "tests/bake/whole_bake.h"
#include "tests/support/sample_pictures.h"
#include "tests/support/temporary_folder.h"

namespace luxel::test {
namespace {

TEST(ImageModule, IsNotNeededByPngJpegAndExr) {
    const TemporaryFolder folder;
    // One of the sample's PNG textures becomes a JPEG.
    const auto scene = edited_sample("painted_room", folder / "scene",
                                     [](nlohmann::json& document) { document["images"][0] = {{"uri", "grey.jpg"}}; });
    publish_file(folder / "scene/grey.jpg", make_jpeg(16, 16, JpegColour::grey, false, std::vector<std::uint8_t>(256, 100)));
    const std::vector<float> nits(8 * 4 * 3, 10.0f);
    publish_file(folder / "sky.exr", encode_exr({8, 4, {"R", "G", "B"}, nits}, ExrSample::float_32, {}));
    BakeOptions options = small_options(scene, {});
    options.sky.picture = folder / "sky.exr";
    const FinishedBake bake = bake_in(folder / "bake", options);
    for (const Warning& warning : bake.report.warnings) EXPECT_EQ(warning.text.find("decode"), std::string::npos) << warning.text;
    const auto holds = [&](std::string_view kind, std::string_view words) {
        return std::any_of(bake.outputs.begin(), bake.outputs.end(), [&](const auto& file) {
            return file.first.ends_with(kind) && file.second.find(words) != std::string::npos;
        });
    };
    EXPECT_TRUE(holds(".exr", "quantity"));
    EXPECT_TRUE(holds(".glb", "tEXtquantity")) << "a PNG for viewers";
    EXPECT_FALSE(image_library_is_loaded());
}

}  // namespace
}  // namespace luxel::test
