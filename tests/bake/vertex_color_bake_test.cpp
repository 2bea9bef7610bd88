// Whole bakes of meshes with colours of their vertices: closed forms, the same light as from base colours, and what a bake folder does
// when only such a colour has changed.
#include <gtest/gtest.h>

#include <cstring>
#include <fstream>

#include "formats/base/bytes.h"
#include "tests/bake/whole_bake.h"
#include "tests/support/temporary_folder.h"

namespace luxel::test {
namespace {

/// The furnace, all vertices in one colour: of its materials, or of the vertices.
std::filesystem::path painted_furnace(const std::filesystem::path& folder, const std::array<float, 3>& color, bool by_vertices) {
    const auto path = edited_sample("furnace", folder, [&](nlohmann::json& document) {
        if (!by_vertices) {
            for (auto& material : document["materials"])
                for (std::size_t c = 0; c < 3; ++c) {
                    auto& factor = material["pbrMetallicRoughness"]["baseColorFactor"][c];
                    factor = factor.get<double>() * static_cast<double>(color[c]);
                }
            return;
        }
        // One colour for all: four vertices that all meshes share.
        const std::size_t at = document["buffers"][0]["byteLength"];
        document["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", at}, {"byteLength", 48}});
        document["buffers"][0]["byteLength"] = at + 48;
        document["accessors"].push_back(
            {{"bufferView", document["bufferViews"].size() - 1}, {"componentType", 5126}, {"type", "VEC3"}, {"count", 4}});
        for (auto& mesh : document["meshes"]) mesh["primitives"][0]["attributes"]["COLOR_0"] = document["accessors"].size() - 1;
    });
    if (by_vertices) {
        std::vector<float> values;
        for (int k = 0; k < 4; ++k) values.insert(values.end(), color.begin(), color.end());
        std::ofstream(folder / "furnace.bin", std::ios::binary | std::ios::app)
            .write(reinterpret_cast<const char*>(values.data()), static_cast<std::streamsize>(values.size() * sizeof(float)));
    }
    return path;
}

FileBytes pictures(const FileBytes& outputs) {
    FileBytes found;
    for (const auto& [name, bytes] : outputs)
        if (name.ends_with(".exr")) found[name] = bytes;
    return found;
}

/// Every wall emits 1 lm/m2 and reflects a half of its vertices' colour: B = 1 / (1 - colour / 2) on all, channel by channel.
TEST(VertexColorBake, TheFurnaceHasItsClosedForm) {
    const TemporaryFolder folder;
    const std::array<float, 3> color{1, 0.5f, 0.125f};
    BakeOptions options = small_options(painted_furnace(folder / "scene", color, true), folder / "out/scene.glb");
    options.tolerance = 1e-5;
    options.work = folder / "work";
    const BakeReport report = bake(options);
    for (const Channels& radiosity : stored_solution(options.work, report.patches).radiosity)
        for (std::size_t c = 0; c < 3; ++c) ASSERT_NEAR(radiosity[c], 1 / (1 - 0.5 * static_cast<double>(color[c])), 2e-4);
    EXPECT_LE(energy_imbalance(report), 1e-4);
}

/// To the last bit, gathered and interpolated: a colour of vertices is a base colour.
TEST(VertexColorBake, IsTheSameAsBaseColour) {
    const TemporaryFolder folder;
    const std::array<float, 3> color{1, 0.5f, 0.125f};
    for (const std::uint32_t gather_rays : {0u, 16u}) {
        const std::filesystem::path here = folder / std::to_string(gather_rays);
        BakeOptions options = small_options(painted_furnace(here / "a", color, false), {});
        options.gather_rays = gather_rays;
        const FinishedBake base = bake_in(here / "base", options);
        options.input = painted_furnace(here / "b", color, true);
        const FinishedBake vertices = bake_in(here / "vertices", options);
        ASSERT_FALSE(pictures(base.outputs).empty());
        EXPECT_EQ(differences(pictures(base.outputs), pictures(vertices.outputs)), "");
        EXPECT_EQ(base.files("evidence"), vertices.files("evidence")) << "rays know nothing of colours";
    }
}

TEST(VertexColorBake, OffIsAsIfThereWereNone) {
    const TemporaryFolder folder;
    BakeOptions options = small_options(painted_furnace(folder / "scene", {1, 0.5f, 0.125f}, true), {});
    options.vertex_colors = false;
    const FinishedBake off = bake_in(folder / "off", options);
    options.input = sample("furnace");
    options.vertex_colors = true;
    const FinishedBake plain = bake_in(folder / "plain", options);
    EXPECT_EQ(differences(plain.stored, off.stored), "");
    EXPECT_EQ(differences(pictures(plain.outputs), pictures(off.outputs)), "");
}

/// Other colours: only the light is solved again.
TEST(VertexColorBake, OtherColoursKeepTheFactors) {
    const TemporaryFolder folder;
    BakeOptions options = small_options(painted_furnace(folder / "scene", {1, 0.5f, 0.125f}, true), folder / "out/scene.glb");
    options.work = folder / "work";
    bake(options);
    options.input = painted_furnace(folder / "other", {0.5f, 1, 0.125f}, true);
    const BakeReport relit = bake(options);
    for (const StageReport& stage : relit.stages) {
        const bool is_kept = stage.name == "unwrap" || stage.name == "evidence" || stage.name == "pooling";
        if (is_kept || stage.name == "solve" || stage.name == "light") {
            EXPECT_EQ(stage.reused, is_kept) << stage.name;
        }
    }
}

/// A wall that is red in part makes all of the room's light redder than its lamp's.
TEST(VertexColorBake, AWallColoursItsNeighbour) {
    const TemporaryFolder folder;
    const auto scene = edited_sample("tinted_room", folder / "scene", [](nlohmann::json& document) {
        for (auto& mesh : document["meshes"])
            if (mesh["name"] == "wall_plus_x") mesh["primitives"][0]["attributes"].erase("COLOR_0");  // the blue one
    });
    const auto red_share = [&](bool on) {
        BakeOptions options = small_options(scene, folder / "out/scene.glb");
        options.vertex_colors = on;
        options.gather_rays = 0;
        const std::vector<PagePixels> pages = lightmap_pages(bake(options));
        double red = 0, blue = 0;
        for (const PagePixels& page : pages)
            for (const auto& pixel : page.pixels) red += static_cast<double>(pixel[0]), blue += static_cast<double>(pixel[2]);
        return red / blue;
    };
    const double lamp = 800.0 / 700;
    EXPECT_NEAR(red_share(false), lamp, 1e-3);
    EXPECT_GT(red_share(true) / lamp, 1.05);
}

}  // namespace
}  // namespace luxel::test
