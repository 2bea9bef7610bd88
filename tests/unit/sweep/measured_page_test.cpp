// Pages and layers as a bake writes them, read back.
#include "baker/sweep/measured_page.h"

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "formats/base/file.h"
#include "formats/image/image_file.h"
#include "tests/support/temporary_folder.h"

namespace luxel {
namespace {

constexpr std::uint32_t width = 3, height = 2;

void write_page(const std::filesystem::path& path) {
    std::vector<float> values;
    for (std::uint32_t k = 0; k < width * height; ++k) values.insert(values.end(), {static_cast<float>(k), 2, 3});
    publish_file(path, encode_exr({width, height, {"R", "G", "B"}, values}, ExrSample::float_32, {}));
}

void write_layers(const std::filesystem::path& path, bool has_error, std::uint32_t layer_height = height) {
    std::vector<ExrPart> parts{{"valid", {"Y"}, ExrSample::uint_32, {}}, {"area", {"Y"}, ExrSample::float_32, {}}};
    if (has_error) parts.push_back({"error", {"Y"}, ExrSample::float_32, {}});
    publish_file(path, encode_exr_parts(width, layer_height, parts, [&](std::size_t part) -> ExrPartValues {
                     const std::size_t count = std::size_t{width} * layer_height;
                     if (part == 1) return std::vector<float>(count, 0.5f);
                     if (part == 2) return std::vector<float>(count, 0.125f);
                     std::vector<std::uint32_t> valid(count, 1);
                     valid[0] = 0, valid[1] = 2, valid[2] = 3;
                     return valid;
                 }));
}

TEST(MeasuredPage, HasTheLightAndTheAreaOfWhatHasLightOfItsOwn) {
    const test::TemporaryFolder folder;
    const auto model = folder / "scene.glb";
    write_page(folder / "scene.lightmap4.exr");
    write_layers(folder / "scene.aov4.exr", true);
    const MeasuredPage page = read_measured_page(model, 4, true);
    EXPECT_EQ(page.light.width, width);
    EXPECT_EQ(page.light.lux[5], (std::array<float, 3>{5, 2, 3}));
    EXPECT_EQ(page.area_m2, (std::vector<float>{0, 0, 0, 0.5f, 0.5f, 0.5f}));
    EXPECT_EQ(page.error, std::vector<float>(6, 0.125f));
    EXPECT_TRUE(read_measured_page(model, 4, false).error.empty());
}

TEST(MeasuredPage, RefusesWhatIsMissingOrDoesNotFit) {
    const test::TemporaryFolder folder;
    const auto model = folder / "scene.glb";
    EXPECT_THROW(read_measured_page(model, 0, false), Error);
    write_page(folder / "scene.lightmap0.exr");
    write_layers(folder / "scene.aov0.exr", false);
    EXPECT_THROW(read_measured_page(model, 0, true), Error) << "no errors in there";
    write_layers(folder / "scene.aov0.exr", false, height + 1);
    EXPECT_THROW(read_measured_page(model, 0, false), Error);
    const std::vector<std::uint8_t> grey(width * height * 3, 128);
    publish_file(folder / "eight.png", encode_png(width, height, grey, {}));
    EXPECT_THROW(read_page_light(folder / "eight.png"), Error);
}

}  // namespace
}  // namespace luxel
