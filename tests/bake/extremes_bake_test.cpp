// Whole bakes at the extremes: brightness, reflectance 0, near 1 and 1, no light, one patch, and the smallest beside the largest.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>

#include "formats/base/file.h"
#include "formats/image/image_file.h"
#include "tests/bake/whole_bake.h"
#include "tests/support/temporary_folder.h"

namespace luxel::test {
namespace {

using nlohmann::json;

double seconds_of(const BakeReport& report, const std::string& stage) {
    double seconds = 0;
    for (const StageReport& entry : report.stages)
        if (entry.name == stage) seconds += entry.seconds;
    return seconds;
}

bool is_skipped(const BakeReport& report, const std::string& part) {
    return std::ranges::any_of(report.skipped, [&](const auto& entry) { return entry.first == part; });
}

void set_colour(json& material, double rho) { material["pbrMetallicRoughness"]["baseColorFactor"] = {rho, rho, rho, 1.0}; }

void expect_finite_pages(const BakeReport& report) {
    for (const PagePixels& page : lightmap_pages(report))
        for (const auto& pixel : page.pixels)
            for (std::size_t c = 0; c < 3; ++c) ASSERT_TRUE(std::isfinite(pixel[c]) && pixel[c] >= 0) << pixel[c];
}

// --- brightness

void set_strength(json& document, double nits) {
    for (json& material : document["materials"])
        if (material.contains("emissiveFactor"))
            material["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"] = nits;
}

/// The 8-bit page with its intensity says what the float page says, as far as a byte can.
void expect_sidecar_restores(const BakeOptions& options, const BakeReport& report) {
    const json sidecar = json::parse(std::ifstream(options.output.string() + ".lightmaps.json"));
    const json model = json::parse(std::ifstream(options.output));
    const auto pages = lightmap_pages(report);
    ASSERT_EQ(sidecar["pages"].size(), pages.size());
    for (std::size_t p = 0; p < pages.size(); ++p) {
        const json& png = sidecar["pages"][p]["png"];
        EXPECT_EQ(sidecar["pages"][p]["exr"]["intensity"], 1.0);
        const auto image = std::ranges::find_if(model["images"], [&](const json& entry) { return entry["name"] == png["name"]; });
        ASSERT_NE(image, model["images"].end());
        const std::string name = (*image)["uri"];
        const ImagePixels bytes = decode_image(read_file(options.output.parent_path() / name), name);
        const double intensity = png["intensity"];
        EXPECT_TRUE(std::isfinite(intensity) && intensity > 0);
        ASSERT_EQ(bytes.pixels.size(), pages[p].pixels.size());
        for (std::size_t k = 0; k < bytes.pixels.size(); ++k)
            for (std::size_t c = 0; c < 3; ++c) {
                const auto byte = static_cast<std::uint8_t>(std::lround(255 * static_cast<double>(bytes.pixels[k][c])));
                const double restored = decode_lightmap_byte(byte, options.encoding) * intensity;
                // A whole step, as bytes are dithered.
                ASSERT_NEAR(restored, static_cast<double>(pages[p].pixels[k][c]), 0.0093 * intensity);
            }
    }
}

class Brightness : public testing::TestWithParam<std::uint32_t> {};

TEST_P(Brightness, ChangesNothingButTheScale) {
    const TemporaryFolder folder;
    std::vector<float> plain;
    // Powers of two, 1.6e-30 and 6e29: other factors round all numbers otherwise, and choices that depend on light fall otherwise here and there.
    for (const double nits : {1.0, 0x1p-99, 0x1p99}) {
        const std::string name = std::to_string(std::lround(std::log10(nits)));
        const auto input = edited_sample("two_rooms", folder / ("scene" + name), [&](json& d) { set_strength(d, nits); });
        BakeOptions options = small_options(input, folder / ("out" + name) / "scene.gltf");
        options.work = folder / ("work" + name);
        options.gather_rays = GetParam();
        const BakeReport report = bake(options);
        EXPECT_TRUE(report.converged);
        EXPECT_LE(energy_imbalance(report), 1e-3);
        expect_finite_pages(report);
        expect_sidecar_restores(options, report);
        const std::vector<float> found = stored_irradiance(options.work);
        if (plain.empty()) plain = found;
        ASSERT_EQ(found.size(), plain.size());
        for (std::size_t k = 0; k < found.size(); ++k) {
            const auto expected = static_cast<double>(plain[k]);
            // A bit in the last place: what is below 1e-38 counts as nothing.
            ASSERT_NEAR(static_cast<double>(found[k]) / nits, expected, 2.5e-7 * expected) << nits << " nits, value " << k;
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Gathered, Brightness, testing::Values(0u, 16u));

TEST(PointLamp, OfAnyBrightness) {
    const TemporaryFolder folder;
    for (const double candela : {1e-30, 1e30}) {
        const auto edit = [&](json& d) {
            d["extensionsUsed"].push_back("KHR_lights_punctual");
            d["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}, {"intensity", candela}}};
            d["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 0;
            set_strength(d, 0);
        };
        BakeOptions options = small_options(edited_sample("furnace", folder / "scene", edit), folder / "out" / "scene.gltf");
        options.work = folder / ("work" + std::to_string(candela > 1));
        const BakeReport report = bake(options);
        expect_finite_pages(report);
        expect_sidecar_restores(options, report);
        EXPECT_NEAR(report.emitted_lm[0] / (4 * 3.14159265 * candela), 1.0, 0.05);
        EXPECT_LE(energy_imbalance(report), 1e-3);
    }
}

// --- reflectance

BakeOptions closed_options(const std::string& sample_name, double rho, const TemporaryFolder& folder) {
    const auto edit = [&](json& document) { set_colour(document["materials"][0], rho); };
    BakeOptions options = small_options(edited_sample(sample_name, folder / "scene", edit), folder / "out.glb");
    options.work = folder / "work";
    return options;
}

TEST(Reflectance, OfZeroNeedsNoSolve) {
    const TemporaryFolder folder;
    const BakeReport report = bake(closed_options("furnace", 0, folder));
    EXPECT_EQ(report.reads, 0);
    EXPECT_EQ(report.error_bound, 0);
    EXPECT_TRUE(is_skipped(report, "solve"));
    for (const float h : stored_irradiance(folder / "work")) ASSERT_NEAR(h, 1, 1e-3);
}

/// Reflectances are 32-bit numbers, so 1 - rho is known to 6e-8 only: 1 - 2^-20 is one of them, 1 - 1e-6 is not.
TEST(Reflectance, NearOneInAClosedRoom) {
    for (const std::string name : {"furnace", "sphere"})
        for (const double rho : {0.999, 1 - 0x1p-20})
            for (const std::string solver : {"shoot", "cg"}) {
                const TemporaryFolder folder;
                BakeOptions options = closed_options(name, rho, folder);
                options.solver = *solver_kind(solver);
                options.tolerance = 1e-4;
                // Shots from chunk to chunk take as many reads as light bounces; in one chunk there are none.
                if (solver == "shoot") options.chunk_patches = 2048;
                const BakeReport report = bake(options);
                EXPECT_TRUE(report.converged);
                EXPECT_EQ(report.chunks > 1, solver == "cg");
                const double expected = 1 / (1 - rho);
                for (const Channels& b : stored_solution(options.work, report.patches).radiosity)
                    for (const double value : b) ASSERT_NEAR(value, expected, 1e-3 * expected);
                for (const float h : stored_irradiance(options.work)) ASSERT_NEAR(h, expected, 1e-3 * expected);
                std::printf("%s, rho 1 - %.1e, %s: %llu patches, %.1f reads, bound %.1e, %.3f s of the stage solve\n", name.c_str(),
                            1 - rho, solver.c_str(), static_cast<unsigned long long>(report.patches), report.reads,
                            report.error_bound, seconds_of(report, "solve"));
                EXPECT_GT(seconds_of(report, "solve"), 0);
            }
}

void expect_endless(const BakeOptions& options, const std::string& material) {
    try {
        bake(options);
        ADD_FAILURE() << "no error";
    } catch (const Error& error) {
        EXPECT_EQ(error.code, ErrorCode::bad_input);
        EXPECT_NE(error.where.find("material \"" + material + "\""), std::string::npos) << error.where;
        EXPECT_NE(error.what_text.find("the light never ends"), std::string::npos) << error.what_text;
    }
}

TEST(Reflectance, OfOneInAClosedRoomIsAClearError) {
    for (const std::string name : {"furnace", "sphere"}) {
        const TemporaryFolder folder;
        expect_endless(closed_options(name, 1, folder), "glow");
    }
    // By a lamp, and in one channel only.
    const TemporaryFolder folder;
    const auto edit = [](json& d) {
        d["extensionsUsed"].push_back("KHR_lights_punctual");
        d["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}, {"intensity", 10}}};
        d["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 0;
        d["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = {0.5, 1.0, 0.25, 1.0};
        set_strength(d, 0);
    };
    expect_endless(small_options(edited_sample("furnace", folder / "scene", edit), folder / "out.glb"), "glow");
}

TEST(Reflectance, OfOneWorksWhereLightCanLeave) {
    const TemporaryFolder folder;
    const auto edit = [](json& d) {
        set_colour(d["materials"][0], 1);
        d["scenes"][0]["nodes"] = {0, 1, 2, 3, 4};  // five walls of six
    };
    const BakeReport report = bake(small_options(edited_sample("furnace", folder / "scene", edit), folder / "out.glb"));
    EXPECT_TRUE(report.converged);
    expect_finite_pages(report);
    EXPECT_LE(energy_imbalance(report), 1e-3);
    // Nothing else ends it.
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(report.lost_lm[c] / report.emitted_lm[c], 1.0, 0.02);
}

/// All of two closed rooms is white but the lamp, a four-hundredth of it: few rays cannot tell, more can.
TEST(Reflectance, OfOneWorksWhereSomethingElseAbsorbs) {
    const TemporaryFolder folder;
    const auto edit = [](json& d) {
        for (json& material : d["materials"])
            if (!material.contains("emissiveFactor")) set_colour(material, 1);
    };
    BakeOptions options = small_options(edited_sample("two_rooms", folder / "scene", edit), folder / "out.glb");
    options.solver = SolverKind::cg;
    options.gather_rays = 0;
    double emitted = 0, before = 101;
    for (const std::uint64_t rays : {64, 256, 4096}) {
        options.rays = rays;
        const BakeReport report = bake(options);
        EXPECT_TRUE(report.converged);
        expect_finite_pages(report);
        EXPECT_LE(energy_imbalance(report), 1e-3);
        EXPECT_TRUE(emitted == 0 || emitted == report.emitted_lm[0]);
        emitted = report.emitted_lm[0];
        const auto warned = std::ranges::find(report.warnings, "white-surfaces", &Warning::code);
        ASSERT_NE(warned, report.warnings.end());
        EXPECT_NE(warned->where.find("material \""), std::string::npos);
        const double percent = std::stod(warned->text.substr(warned->text.find("for ") + 4));
        std::printf("%llu rays: of %.0f %% of the light they cannot tell where it ends\n",
                    static_cast<unsigned long long>(rays), percent);
        EXPECT_LT(percent, before);
        before = percent;
    }
    EXPECT_LT(before, 20);
}

/// A closed white room beside a larger grey one, without a ray between them.
TEST(Reflectance, OfOneInOneOfTwoClosedRoomsIsAClearError) {
    const TemporaryFolder folder;
    const auto edit = [](double rho) {
        return [rho](json& d) {
            const json walls = d["scenes"][0]["nodes"];
            json white = d["materials"][0];
            white["name"] = "snow";
            set_colour(white, rho);
            d["materials"].push_back(white);
            json second = json::array();
            for (const json& wall : walls) {
                json mesh = d["meshes"][d["nodes"][wall.get<std::size_t>()]["mesh"].get<std::size_t>()];
                mesh["primitives"][0]["material"] = 1;
                d["meshes"].push_back(mesh);
                d["nodes"].push_back({{"mesh", d["meshes"].size() - 1}});
                second.push_back(d["nodes"].size() - 1);
            }
            d["nodes"].push_back({{"children", second}, {"translation", {5, 0, 0}}, {"scale", {0.5, 0.5, 0.5}}});
            d["scenes"][0]["nodes"].push_back(d["nodes"].size() - 1);
        };
    };
    expect_endless(small_options(edited_sample("furnace", folder / "scene", edit(1)), folder / "out.glb"), "snow");
    const BakeReport grey = bake(small_options(edited_sample("furnace", folder / "scene", edit(0.75)), folder / "out.glb"));
    EXPECT_TRUE(grey.warnings.empty());
}

// --- little

TEST(Little, NoLight) {
    const TemporaryFolder folder;
    const auto input = edited_sample("two_rooms", folder / "scene", [](json& d) { set_strength(d, 0); });
    BakeOptions options = small_options(input, folder / "out.glb");
    options.work = folder / "work";
    const BakeReport report = bake(options);
    EXPECT_TRUE(report.converged);
    EXPECT_EQ(report.reads, 0);
    EXPECT_TRUE(is_skipped(report, "solve"));
    for (const float h : stored_irradiance(options.work)) ASSERT_EQ(h, 0);
}

TEST(Little, OnePatchThatSeesNothing) {
    const TemporaryFolder folder;
    const auto input = edited_sample("furnace", folder / "scene", [](json& d) { d["scenes"][0]["nodes"] = {0}; });
    BakeOptions options = small_options(input, folder / "out.glb");
    options.work = folder / "work";
    options.patch_texels = 64;
    const BakeReport report = bake(options);
    EXPECT_EQ(report.patches, 1u);
    EXPECT_EQ(report.pairs, 0u);
    EXPECT_TRUE(report.converged);
    for (const float h : stored_irradiance(options.work)) ASSERT_EQ(h, 0);
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(report.lost_lm[c] / report.emitted_lm[c], 1.0, 1e-6);
}

/// A furnace of 1000 m with a triangle of 1e-6 m in its middle: areas over 16 orders of magnitude, H = M / (1 - rho) on both.
TEST(Little, TinyTriangleInAVastHall) {
    const TemporaryFolder folder;
    const auto edit = [](json& d) {
        json walls = d["scenes"][0]["nodes"];
        const std::size_t node = d["nodes"].size();
        d["nodes"].push_back({{"name", "hall"}, {"children", walls}, {"scale", {500, 500, 500}}});
        d["nodes"].push_back({{"name", "mote"}, {"mesh", d["meshes"].size()}, {"scale", {1e-6, 1e-6, 1e-6}}});
        d["scenes"][0]["nodes"] = {node, node + 1};
        // (0 0 0) (1 0 0) (0 0 -1) as floats
        const std::string corners = "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAAAAAAIC/";
        d["buffers"].push_back({{"byteLength", 36}, {"uri", "data:application/octet-stream;base64," + corners}});
        d["bufferViews"].push_back({{"buffer", 1}, {"byteLength", 36}});
        d["accessors"].push_back({{"bufferView", d["bufferViews"].size() - 1}, {"componentType", 5126}, {"count", 3},
                                  {"type", "VEC3"}, {"min", {0, 0, -1}}, {"max", {1, 0, 0}}});
        const json position = {{"POSITION", d["accessors"].size() - 1}};
        d["meshes"].push_back({{"primitives", {{{"attributes", position}, {"material", 0}}}}});
    };
    BakeOptions options = small_options(edited_sample("furnace", folder / "scene", edit), folder / "out.glb");
    options.work = folder / "work";
    options.unwrap.texels_per_metre = 0.02;
    options.tolerance = 1e-5;
    for (const std::uint32_t gather_rays : {0u, 16u}) {
        options.gather_rays = gather_rays;
        const BakeReport report = bake(options);
        EXPECT_EQ(report.triangles, 13u);
        EXPECT_TRUE(report.converged);
        EXPECT_LE(energy_imbalance(report), 1e-3);
        expect_finite_pages(report);
        const SolveResult solution = stored_solution(options.work, report.patches);
        for (const Channels& b : solution.radiosity)
            for (const double value : b) ASSERT_NEAR(value, 2, 2e-3);
        std::filesystem::remove_all(options.work);
    }
}

}  // namespace
}  // namespace luxel::test
