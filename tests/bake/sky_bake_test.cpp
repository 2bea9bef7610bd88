// Whole bakes under a sky: closed forms, and another sky without new rays.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "formats/base/file.h"
#include "formats/image/image_file.h"
#include "tests/bake/whole_bake.h"
#include "tests/support/temporary_folder.h"

namespace luxel::test {
namespace {

bool reused(const BakeReport& report, const std::string& stage) {
    for (const StageReport& entry : report.stages)
        if (entry.name == stage) return entry.reused;
    ADD_FAILURE() << "no stage " << stage;
    return false;
}

BakeOptions court(const TemporaryFolder& folder) {
    BakeOptions options = small_options(sample("open_court"), folder / "out/scene.glb");
    options.unwrap.texels_per_metre = 2;
    options.work = folder / "work";
    return options;
}

/// A sky of two halves by height, with one far brighter pixel.
std::filesystem::path write_sky(const std::filesystem::path& path, float above) {
    constexpr std::uint32_t width = 32, height = 16;
    std::vector<float> values;
    for (std::uint32_t y = 0; y < height; ++y)
        for (std::uint32_t x = 0; x < width; ++x)
            for (int c = 0; c < 3; ++c)
                values.push_back(x == 20 && y == 3 ? 500 * above : y < height / 2 ? above : 0.1f * above);
    publish_file(path, encode_exr({width, height, {"R", "G", "B"}, values}, ExrSample::float_32,
                                  {"radiance", "nits", "linear", 1, "test", {}}));
    return path;
}

TEST(SkyBake, AnOpenFloorHasPiTimesTheSkyInEveryTexel) {
    const TemporaryFolder folder;
    BakeOptions options = small_options(edited_sample("lamps_over_floor", folder / "scene",
                                                      [](nlohmann::json& document) {
                                                          for (auto& node : document["nodes"]) node.erase("extensions");
                                                      }),
                                        folder / "out/scene.glb");
    options.work = folder / "work";
    options.unwrap.texels_per_metre = 4;
    options.sky.color = std::array{100.0, 50.0, 10.0};
    options.sky.scale = 2;
    for (const std::uint32_t rays : {0u, 16u}) {
        options.gather_rays = rays;
        std::filesystem::remove_all(options.work);
        bake(options);
        const std::vector<float> light = stored_irradiance(options.work);
        ASSERT_GT(light.size(), 1000u);
        for (std::size_t k = 0; k < light.size(); k += 3) {
            ASSERT_NEAR(light[k], 200 * 3.14159265f, 1e-2f);
            ASSERT_NEAR(light[k + 2], 20 * 3.14159265f, 1e-3f);
        }
    }
}

TEST(SkyBake, AnotherSkyNeedsNoNewRays) {
    const TemporaryFolder folder;
    BakeOptions options = court(folder);
    options.sky.picture = write_sky(folder / "first.exr", 100);
    const BakeReport first = bake(options);
    EXPECT_FALSE(reused(first, "sky view"));
    options.sky.picture = write_sky(folder / "second.exr", 300);
    options.sky.turn_degrees = 77;
    options.verify = true;
    const BakeReport second = bake(options);
    ASSERT_TRUE(second.verification);
    EXPECT_TRUE(second.verification->passed());
    options.verify = false;
    for (const char* stage : {"sky view", "evidence", "pooling", "closure"})
        EXPECT_TRUE(reused(second, stage)) << stage;
    for (const char* stage : {"solve", "light"}) EXPECT_FALSE(reused(second, stage)) << stage;
    EXPECT_GT(second.emitted_lm[0], 1.5 * first.emitted_lm[0]);
    EXPECT_LT(energy_imbalance(second), 1e-3);
    // The same from nothing: importance is that of another light there, so all patches get the same rays.
    const TemporaryFolder fresh;
    BakeOptions again = options;
    again.work = fresh / "work";
    again.importance = false;
    BakeOptions even = options;
    even.importance = false;
    bake(even);
    const FileBytes even_relit = files_below(folder / "out");
    bake(again);
    EXPECT_EQ(differences(even_relit, files_below(folder / "out")), "");
}

TEST(SkyBake, ADamagedViewIsNamed) {
    const TemporaryFolder folder;
    BakeOptions options = court(folder);
    options.sky.color = std::array{100.0, 100.0, 100.0};
    bake(options);
    const auto view = stored_file(options.work, "sky-");
    std::fstream file(view, std::ios::in | std::ios::out | std::ios::binary);
    const auto at = static_cast<std::streamoff>(std::filesystem::file_size(view) / 2);
    const int byte = file.seekg(at).get();
    file.seekp(at).put(static_cast<char>(byte ^ 4)).flush();
    options.sky.scale = 2;
    try {
        bake(options);
        ADD_FAILURE() << "nothing was thrown";
    } catch (const Error& error) {
        EXPECT_EQ(error.code, ErrorCode::damaged_store);
        EXPECT_NE(error.where.find(view.filename().string()), std::string::npos) << error.where;
        EXPECT_FALSE(error.hint.empty());
    }
    std::filesystem::remove(view);
    EXPECT_FALSE(reused(bake(options), "sky view"));
}

TEST(SkyBake, ThreadsDoNotMatter) {
    const TemporaryFolder one, many;
    BakeOptions options = court(one);
    options.sky.picture = write_sky(one / "sky.exr", 100);
    options.lamp_radius = 0.1;
    options.threads = 1;
    bake(options);
    BakeOptions other = court(many);
    other.sky.picture = options.sky.picture;
    other.lamp_radius = 0.1;
    other.threads = 3;
    bake(other);
    EXPECT_EQ(differences(files_below(one / "work"), files_below(many / "work")), "");
}

TEST(SkyBake, PicturesThatAreNoSkyAreRefused) {
    const TemporaryFolder folder;
    BakeOptions options = court(folder);
    const auto refused = [&](const std::string& what) {
        try {
            bake(options);
        } catch (const Error& error) {
            EXPECT_EQ(error.code, ErrorCode::bad_input);
            EXPECT_NE(error.what_text.find(what), std::string::npos) << error.what_text;
            return;
        }
        ADD_FAILURE() << "nothing was thrown";
    };
    options.sky.picture = folder / "none.exr";
    refused("");
    const std::vector<std::uint8_t> pixels(24, 7);
    publish_file(folder / "flat.png", encode_png(4, 2, pixels, {}));
    options.sky.picture = folder / "flat.png";
    refused("floats");
    const std::vector<float> values(27, 1.0f);
    publish_file(folder / "square.exr", encode_exr({3, 3, {"R", "G", "B"}, values}, ExrSample::float_32, {}));
    options.sky.picture = folder / "square.exr";
    refused("twice as wide");
    std::ofstream(folder / "text.hdr") << "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 999999 +X 1999998\n";
    options.sky.picture = folder / "text.hdr";
    refused("");
}

}  // namespace
}  // namespace luxel::test
