// What a scene does not need is left out, is said to be, and changes no light: each part, on a scene made for it, against the same bake with
// that part forced. Prints the processor seconds of both, of the stage that gains most and of all. LUXEL_NEEDS_DENSITY: texels per metre, of the build.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>

#include "formats/base/base64.h"
#include "formats/base/file.h"
#include "formats/image/image_file.h"
#include "tests/bake/whole_bake.h"
#include "tests/support/temporary_folder.h"

namespace luxel::test {
namespace {

/// Of the stages of this name; "": of all.
double processor_seconds(const BakeReport& report, const std::string& name) {
    double sum = 0;
    for (const StageReport& stage : report.stages)
        if (name.empty() || stage.name == name) sum += stage.processor_seconds;
    return sum;
}

bool is_skipped(const BakeReport& report, Part part) {
    return std::ranges::any_of(report.skipped, [&](const auto& entry) { return entry.first == part_name(part); });
}

/// Root mean square of the difference over the mean, of texels page after page.
double difference(const std::vector<float>& a, const std::vector<float>& b) {
    EXPECT_EQ(a.size(), b.size());
    double squares = 0, sum = 0;
    for (std::size_t k = 0; k < std::min(a.size(), b.size()); ++k) {
        squares += std::pow(static_cast<double>(a[k]) - static_cast<double>(b[k]), 2);
        sum += static_cast<double>(b[k]);
    }
    return sum > 0 ? std::sqrt(squares * static_cast<double>(b.size())) / sum : squares;
}

struct Compared {
    FinishedBake plain, forced;
    double difference = 0;
};

/// Bakes without and with the part forced. `stage`: where it takes its time.
Compared compare(const TemporaryFolder& folder, BakeOptions options, Part part, const char* stage) {
    options.unwrap.texels_per_metre = LUXEL_NEEDS_DENSITY;
    options.unwrap.page_size = 1024;
    options.patch_texels = 4;
    options.chunk_patches = 512;
    Compared out;
    out.plain = bake_in(folder / "plain", options);
    const std::vector<float> light = stored_irradiance(folder / "plain/work");
    options.forced.add(part);
    out.forced = bake_in(folder / "forced", options);
    out.difference = difference(light, stored_irradiance(folder / "forced/work"));
    EXPECT_TRUE(is_skipped(out.plain.report, part));
    EXPECT_FALSE(is_skipped(out.forced.report, part));
    EXPECT_GT(light.size(), 1000u);
    const auto seconds = [&](const char* name) { return std::array{processor_seconds(out.plain.report, name), processor_seconds(out.forced.report, name)}; };
    const auto own = seconds(stage), all = seconds("");
    std::printf("| %s | %s | %s | %.3f / %.3f | %.2f / %.2f | %.1e |\n", part_name(part), options.input.stem().c_str(), stage, own[0], own[1], all[0], all[1], out.difference);
    return out;
}

/// Paths and keys in JSON differ; pages must not.
void expect_same_pages(const Compared& bakes) {
    for (const auto& [name, bytes] : bakes.plain.outputs)
        if (name.ends_with(".exr")) {
            EXPECT_TRUE(bytes == bakes.forced.outputs.at(name)) << name;
        }
}

BakeOptions options_for(const std::filesystem::path& scene, const TemporaryFolder& folder) { return small_options(scene, folder / "out/scene.glb"); }

void for_materials(nlohmann::json& document, const std::function<void(nlohmann::json&)>& edit) {
    for (auto& material : document["materials"]) edit(material);
}

/// The same value in all channels.
void make_grey(nlohmann::json& colour) { colour[1] = colour[2] = colour[0]; }

TEST(NeedsBake, CopiesOfAMeshAreUnwrappedOnce) {
    const TemporaryFolder folder;
    const auto scene = edited_sample("sphere", folder / "scene", [](nlohmann::json& document) {
        const nlohmann::json nodes = document["nodes"];
        for (int k = 1; k <= 12; ++k)
            for (nlohmann::json node : nodes) {
                document["scenes"][0]["nodes"].push_back(document["nodes"].size());
                node["translation"] = {5 * k, 0, 0};
                document["nodes"].push_back(node);
            }
    });
    const Compared bakes = compare(folder, options_for(scene, folder), Part::copies, "unwrap");
    EXPECT_EQ(bakes.difference, 0);
    EXPECT_EQ(differences(bakes.plain.files("atlas"), bakes.forced.files("atlas")), "");
    expect_same_pages(bakes);
}

TEST(NeedsBake, TexturesOfOneColourArePartOfTheMaterial) {
    const TemporaryFolder folder;
    const std::vector<std::uint8_t> pixels(std::size_t{256} * 256 * 3, 200);
    const Bytes png = encode_png(256, 256, pixels, {});
    const auto scene = edited_sample("painted_room", folder / "scene", [&](nlohmann::json& document) {
        for (auto& image : document["images"]) image = {{"uri", "data:image/png;base64," + encode_base64(png)}, {"mimeType", "image/png"}};
    });
    // A mean over equal pixels is rounded: choices that light decides may fall otherwise.
    const Compared bakes = compare(folder, options_for(scene, folder), Part::textures, "patches");
    EXPECT_LE(bakes.difference, 2e-3);
}

TEST(NeedsBake, RaysAskOnlySurfacesThatLetLightPass) {
    const TemporaryFolder folder;
    const Compared bakes = compare(folder, options_for(sample("corridor_4"), folder), Part::see_through, "light");
    EXPECT_EQ(bakes.difference, 0);
    expect_same_pages(bakes);
}

/// Outside of the walls there is nothing. (The back of the sign would see a wall, the inside of the chest the floor.)
TEST(NeedsBake, BacksThatNothingSeesHaveNoPatches) {
    const TemporaryFolder folder;
    const auto scene = edited_sample("painted_room", folder / "scene", [](nlohmann::json& document) {
        for_materials(document, [](nlohmann::json& material) { material["doubleSided"] = material["name"] == "wallpaper" || material["name"] == "tiles"; });
    });
    BakeOptions options = options_for(scene, folder);
    options.importance = false;  // it would share out more rays among more patches; what is left are sums in another order
    const Compared bakes = compare(folder, options, Part::back_patches, "evidence");
    EXPECT_LE(bakes.difference, 5e-3);
    EXPECT_GT(bakes.forced.report.patches, bakes.plain.report.patches);
}

TEST(NeedsBake, LampsWithoutPowerCastNoShadows) {
    const TemporaryFolder folder;
    const auto scene = edited_sample("two_rooms", folder / "scene", [](nlohmann::json& document) {
        document["extensionsUsed"].push_back("KHR_lights_punctual");
        document["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}, {"intensity", 0.0}}};
        for (int k = 0; k < 300; ++k) {  // a level with its lamps switched off
            document["scenes"][0]["nodes"].push_back(document["nodes"].size());
            document["nodes"].push_back({{"translation", {0.5 + 0.01 * k, 1.5, 1.0}}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
        }
    });
    const Compared bakes = compare(folder, options_for(scene, folder), Part::lamps, "light");
    EXPECT_EQ(bakes.difference, 0);
    expect_same_pages(bakes);
}

TEST(NeedsBake, ASkyThatNothingSeesIsNotSampled) {
    const TemporaryFolder folder;
    std::vector<float> nits;
    for (std::uint32_t k = 0; k < 32 * 16; ++k) nits.insert(nits.end(), 3, k % 7 == 0 ? 5000.0f : 100.0f);
    publish_file(folder / "sky.exr", encode_exr({32, 16, {"R", "G", "B"}, nits}, ExrSample::float_32, {"radiance", "nits", "linear", 1, "test", {}}));
    BakeOptions options = options_for(sample("painted_room"), folder);
    options.sky.picture = folder / "sky.exr";
    // Beside rays that are aimed at the sky emitters are estimated otherwise, with another noise.
    const Compared bakes = compare(folder, options, Part::sky, "light");
    EXPECT_LE(bakes.difference, 2e-2);
}

TEST(NeedsBake, GreyLightIsJudgedOnce) {
    const TemporaryFolder folder;
    const auto scene = edited_sample("two_rooms", folder / "scene", [](nlohmann::json& document) {
        for_materials(document, [](nlohmann::json& material) {
            make_grey(material["pbrMetallicRoughness"]["baseColorFactor"]);
            if (material.contains("emissiveFactor")) make_grey(material["emissiveFactor"]);
        });
    });
    const Compared bakes = compare(folder, options_for(scene, folder), Part::colours, "accuracy");
    EXPECT_EQ(bakes.difference, 0);
    expect_same_pages(bakes);
    EXPECT_EQ(bakes.plain.report.standard_error, bakes.forced.report.standard_error);
}

TEST(NeedsBake, BlackSurfacesNeedNoFormFactors) {
    const TemporaryFolder folder;
    const auto scene = edited_sample("two_rooms", folder / "scene", [](nlohmann::json& document) {
        for_materials(document, [](nlohmann::json& material) { material["pbrMetallicRoughness"]["baseColorFactor"] = {0, 0, 0, 1}; });
    });
    BakeOptions options = options_for(scene, folder);
    const Compared bakes = compare(folder, options, Part::solve, "evidence");
    EXPECT_EQ(bakes.difference, 0);
    expect_same_pages(bakes);
    EXPECT_EQ(bakes.plain.report.most_rays, 64u);
    EXPECT_GT(bakes.forced.report.most_rays, 64u);
}

/// A second room beside the first, with the same walls and no lamp.
TEST(NeedsBake, NothingIsGatheredInADarkRoom) {
    const TemporaryFolder folder;
    const auto scene = edited_sample("painted_room", folder / "scene", [](nlohmann::json& document) {
        const nlohmann::json nodes = document["nodes"];
        for (const auto& node : nodes) {
            if (node["name"] == "sign") continue;
            document["scenes"][0]["nodes"].push_back(document["nodes"].size());
            document["nodes"].push_back(node);
            document["nodes"].back()["name"] = "dark_" + node["name"].get<std::string>();
            document["nodes"].back()["translation"] = {10, 0, 0};
        }
    });
    const Compared bakes = compare(folder, options_for(scene, folder), Part::dark_patches, "light");
    EXPECT_EQ(bakes.difference, 0);
    EXPECT_LT(bakes.plain.report.gathering->rays_per_texel, 0.7 * bakes.forced.report.gathering->rays_per_texel);
    EXPECT_EQ(bakes.plain.report.least_rays, 64u) << "and rays of patches go elsewhere";
}

TEST(NeedsBake, NothingIsGatheredInTheOpenWhereNothingShines) {
    const TemporaryFolder folder;
    const Compared bakes = compare(folder, options_for(sample("open_court"), folder), Part::dark_patches, "light");
    EXPECT_EQ(bakes.difference, 0);
    EXPECT_EQ(bakes.plain.report.gathering->rays_per_texel, 0);
    EXPECT_GT(bakes.forced.report.gathering->rays_per_texel, 0);
}

/// In the open no ray of most patches meets the lamp, and few of its own meet them: texels aim at it.
TEST(NeedsBake, ASmallLampFarAwayLightsWhatNoRayJoinsToIt) {
    const TemporaryFolder folder;
    const auto scene = edited_sample("two_squares_parallel", folder / "scene", [](nlohmann::json& document) {
        for (auto& node : document["nodes"])
            if (document["materials"][document["meshes"][node["mesh"].get<std::size_t>()]["primitives"][0]["material"].get<std::size_t>()].contains("emissiveFactor"))
                node["scale"] = {0.002, 1, 0.002};
    });
    BakeOptions options = options_for(scene, folder);
    options.unwrap.texels_per_metre = 48;
    options.rays = 64;
    const FinishedBake plain = bake_in(folder / "plain", options);
    const std::vector<float> light = stored_irradiance(folder / "plain/work");
    options.forced.add(Part::dark_patches);
    bake_in(folder / "forced", options);
    EXPECT_EQ(difference(light, stored_irradiance(folder / "forced/work")), 0);
    EXPECT_FALSE(is_skipped(plain.report, Part::dark_patches));
    EXPECT_GT(std::ranges::count_if(light, [](float lux) { return lux > 0; }), 3000);
}

TEST(NeedsBake, BlocksThatFitAreReadOnce) {
    const TemporaryFolder folder;
    BakeOptions options = options_for(sample("corridor_4"), folder);
    options.solver = SolverKind::jacobi;
    options.tolerance = 1e-6;
    const Compared bakes = compare(folder, options, Part::disk, "solve");
    EXPECT_EQ(bakes.difference, 0);
    expect_same_pages(bakes);
    EXPECT_EQ(bakes.plain.report.solve_path, "in memory");
    EXPECT_EQ(bakes.forced.report.solve_path, "out of core");
    EXPECT_GT(bakes.forced.report.reads, bakes.plain.report.reads);
}

TEST(NeedsBake, EverythingCanBeForced) {
    const TemporaryFolder folder;
    BakeOptions options = options_for(sample("two_rooms"), folder);
    options.forced = every_part();
    const FinishedBake bake = bake_in(folder / "forced", options);
    for (const PartInfo& info : all_parts)
        EXPECT_EQ(is_skipped(bake.report, info.part), info.part == Part::sky) << info.name << ": where there is no sky none can be sampled";
    EXPECT_EQ(parse_parts(part_names(every_part()), "test"), every_part());
    EXPECT_THROW(parse_parts("sky,clouds", "test"), Error);
}

}  // namespace
}  // namespace luxel::test
