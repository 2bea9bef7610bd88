// Scenes that others made: every one with triangles bakes, and no lightmap holds a number that is not light.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "baker/scene/scene_build.h"
#include "formats/gltf/gltf_in.h"
#include "tests/bake/whole_bake.h"
#include "tests/support/temporary_folder.h"

namespace luxel::test {
namespace {

std::filesystem::path scenes_folder() {
    const char* value = std::getenv("LUXEL_SCENES");
    return value ? std::filesystem::path(value) : source_folder() / "../shared/scenes";
}

std::vector<std::filesystem::path> scene_files() {
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(scenes_folder()))
        if (entry.path().extension() == ".glb" || entry.path().extension() == ".gltf") files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    return files;
}

/// Does the file show a triangle? Lines and points are no surface.
bool has_triangles(const std::filesystem::path& path) {
    const GltfDocument document = load_gltf(path);
    const SceneRecord record = read_scene(document);
    std::vector<Warning> ignored;
    const auto no_picture = [](ByteView, const std::string&) { return std::optional<DecodedImage>(); };
    return build_scene(record, no_picture, {}, ignored).triangle_count() > 0;
}

/// Files of the glTF asset generator that ask for a version or an extension which nobody has: they must be refused.
bool must_be_refused(const std::string& name) {
    return name == "Compatibility_04.gltf" || name == "Compatibility_05.gltf";
}

/// Draft, with pages so small that a scene of few charts has at most 20,000 texels.
BakeOptions draft_options(const std::filesystem::path& input, const std::filesystem::path& folder) {
    BakeOptions options;
    options.input = input;
    options.output = folder / (input.stem().string() + ".glb");
    options.unwrap.page_size = 200;
    options.rays = 256;
    options.gather_rays = 0;
    options.tolerance = 1e-2;
    options.threads = 2;
    options.memory_bytes = std::uint64_t{4} << 30;
    return options;
}

void expect_light(const BakeReport& report) {
    const auto pages = lightmap_pages(report);
    EXPECT_EQ(pages.size(), report.pages);
    for (const PagePixels& page : pages)
        for (const auto& pixel : page.pixels)
            for (std::size_t c = 0; c < 3; ++c)
                ASSERT_TRUE(std::isfinite(pixel[c]) && pixel[c] >= 0) << "a texel holds " << pixel[c];
}

TEST(ForeignScenes, AllWithTrianglesBake) {
    if (!std::filesystem::is_directory(scenes_folder())) GTEST_SKIP() << "no folder " << scenes_folder();
    const bool big = std::getenv("LUXEL_BIG") != nullptr;
    const char* only = std::getenv("LUXEL_ONLY");
    int baked = 0;
    for (const auto& path : scene_files()) {
        const std::string name = path.filename().string();
        if (!big && (name == "city.glb" || name == "city-xl.glb")) continue;
        if (only && path.string().find(only) == std::string::npos) continue;
        SCOPED_TRACE(path.string());
        try {
            if (!has_triangles(path)) {
                std::printf("%-36s no triangles\n", name.c_str());
                continue;
            }
            const TemporaryFolder folder;
            const BakeReport report = bake(draft_options(path, folder.path()));
            expect_light(report);
            // What is still under way when the solve stops is neither absorbed nor lost.
            EXPECT_LE(energy_imbalance(report), 1e-3 + report.error_bound);
            double seconds = 0;
            for (const StageReport& stage : report.stages) seconds += stage.seconds;
            std::printf("%-36s %8llu triangles %7llu texels %6llu patches %9llu pairs %6.1f s %5llu MB  %zu warnings\n",
                        name.c_str(), static_cast<unsigned long long>(report.triangles),
                        static_cast<unsigned long long>(report.texels), static_cast<unsigned long long>(report.patches),
                        static_cast<unsigned long long>(report.pairs), seconds,
                        static_cast<unsigned long long>(report.peak_bytes >> 20), report.warnings.size());
            ++baked;
            EXPECT_FALSE(must_be_refused(name));
        } catch (const Error& error) {
            if (!must_be_refused(name)) ADD_FAILURE() << error.what();
            EXPECT_EQ(error.code, ErrorCode::bad_input);
            std::printf("%-36s refused: %s\n", name.c_str(), error.what_text.c_str());
        }
        std::fflush(stdout);
    }
    EXPECT_GT(baked, 0);
}

}  // namespace
}  // namespace luxel::test
