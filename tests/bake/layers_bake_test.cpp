// Layers beside the lightmap of a whole bake: what is asked for is there, says what the scene is, and sums to the
// lightmap.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "baker/bake/geometry_stages.h"
#include "baker/bake/stage_clock.h"
#include "baker/bake/seam_stage.h"
#include "baker/bake/write_stage.h"
#include "formats/base/file.h"
#include "tests/bake/whole_bake.h"
#include "tests/support/exr_parts.h"
#include "tests/support/temporary_folder.h"

namespace luxel::test {
namespace {

Bytes bytes_of(const FileBytes& files, const std::string& name) {
    const std::string& text = files.at(name);
    return {text.begin(), text.end()};
}

TEST(Layers, OfTheCornellBox) {
    const TemporaryFolder folder;
    BakeOptions options = small_options(sample("cornell_box"), {});
    options.unwrap.texels_per_metre = 16;  // of a box half a metre wide
    options.gather_rays = 0;
    options.layers = {Layer::albedo, Layer::normal, Layer::patch, Layer::chart, Layer::valid};
    const FinishedBake bake = bake_in(folder.path(), options);
    ASSERT_GE(bake.report.pages, 1u);
    std::size_t covered = 0, green = 0, red = 0;
    std::vector<bool> patch_seen(bake.report.patches);
    for (std::uint32_t page = 0; page < bake.report.pages; ++page) {
        const auto parts = read_exr_parts(bytes_of(bake.outputs, "scene.aov" + std::to_string(page) + ".exr"));
        ASSERT_EQ(parts.size(), 5u);
        const ReadExrPart &albedo = parts[0], &normal = parts[1], &patch = parts[2], &chart = parts[3],
                          &valid = parts[4];
        EXPECT_EQ(albedo.name, "albedo");
        EXPECT_EQ(valid.name, "valid");
        EXPECT_EQ(valid.width, 64u);
        EXPECT_EQ(valid.height, 64u);
        for (std::size_t at = 0; at < valid.numbers.size(); ++at) {
            const std::uint32_t state = valid.numbers[at];
            const float *rho = &albedo.floats[3 * at], *n = &normal.floats[3 * at];
            ASSERT_LE(state, 3u);
            EXPECT_EQ(chart.numbers[at] < bake.report.charts, state == 1 || state == 3);
            if (state != 1) continue;
            ++covered;
            ASSERT_LT(patch.numbers[at], bake.report.patches);
            patch_seen[patch.numbers[at]] = true;
            EXPECT_NEAR(n[0] * n[0] + n[1] * n[1] + n[2] * n[2], 1, 1e-5);
            // The walls of colour are those that look along x: the green one stands at x = 0, the red one at x = 0.55
            // m.
            const bool is_green = std::abs(rho[0] - 0.14f) < 1e-4f, is_red = std::abs(rho[1] - 0.065f) < 1e-4f;
            green += is_green, red += is_red;
            if (is_green || is_red) {
                EXPECT_GT(std::abs(n[0]), 0.99f);
                EXPECT_EQ(n[0] > 0, is_green);
            }
        }
    }
    EXPECT_GT(covered, 500u);
    EXPECT_GT(green, 40u);
    EXPECT_GT(red, 40u);
    EXPECT_EQ(std::count(patch_seen.begin(), patch_seen.end(), false), 0) << "every patch has a texel";
    const auto sidecar = nlohmann::json::parse(bake.outputs.at("scene.glb.lightmaps.json"));
    for (const auto& page : sidecar["pages"]) {
        EXPECT_TRUE(bake.outputs.contains(page["layers"]["uri"]));
        EXPECT_EQ(page["layers"]["parts"].size(), 5u);
    }
}

TEST(Layers, OfLightThatIsNotKnownInPartsAreRefused) {
    const TemporaryFolder folder;
    BakeOptions options = small_options(sample("cornell_box"), folder / "out.glb");
    options.gather_rays = 0;
    options.layers = {Layer::indirect, Layer::albedo};
    try {
        bake(options);
        ADD_FAILURE() << "accepted";
    } catch (const Error& error) {
        EXPECT_EQ(error.code, ErrorCode::usage);
        EXPECT_NE(error.what_text.find("\"indirect\""), std::string::npos);
        EXPECT_NE(error.hint.find("albedo"), std::string::npos);
    }
    EXPECT_FALSE(std::filesystem::exists(folder / "out.glb"));
}

double median_of(std::vector<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

/// What the error layer says is how far the light of bakes with other random numbers scatters, of a texel in the middle. Of all together, by
/// squares, it is less: in a corner one bake in a hundred finds light that the others have not met, and no bake knows what it has missed
/// (320 seeds: 0.53).
TEST(Layers, ErrorIsHowFarSeedsScatter) {
    constexpr std::size_t seeds = 8;
    std::vector<std::vector<ReadExrPart>> bakes;
    for (std::size_t seed = 0; seed < seeds; ++seed) {
        const TemporaryFolder folder;
        BakeOptions options = small_options(sample("cornell_box"), {});
        options.unwrap.texels_per_metre = 16;
        options.rays = 1024;  // the solve is nearly the same in all of them
        options.gather_rays = 64;
        options.seed = seed;
        options.layers = {Layer::direct, Layer::indirect, Layer::error, Layer::samples, Layer::valid};
        const FinishedBake bake = bake_in(folder.path(), options);
        bakes.push_back(read_exr_parts(bytes_of(bake.outputs, "scene.aov0.exr")));
    }
    std::vector<double> scatters, errors;
    for (std::size_t at = 0; at < bakes[0][4].numbers.size(); ++at) {
        if (bakes[0][4].numbers[at] != 1) continue;
        double sum = 0, squares = 0, error = 0;
        for (const std::vector<ReadExrPart>& parts : bakes) {
            double value = 0;
            constexpr std::array<double, 3> weights{0.2126, 0.7152, 0.0722};
            for (std::size_t c = 0; c < 3; ++c)
                value += weights[c] * static_cast<double>(parts[0].floats[3 * at + c] + parts[1].floats[3 * at + c]);
            sum += value, squares += value * value;
            error += static_cast<double>(parts[2].floats[at]) / seeds;
            EXPECT_GE(parts[3].numbers[at], 64u);
        }
        const double mean = sum / seeds;
        if (!(mean > 0)) continue;
        scatters.push_back((squares / seeds / (mean * mean) - 1) * seeds / (seeds - 1));
        errors.push_back(error * error);
    }
    ASSERT_GT(errors.size(), 200u);
    const auto sum_of = [](const std::vector<double>& values) { return std::accumulate(values.begin(), values.end(), 0.0); };
    const double typical = std::sqrt(median_of(errors) / median_of(scatters)), all = std::sqrt(sum_of(errors) / sum_of(scatters));
    RecordProperty("said_over_scatter", std::to_string(typical));
    RecordProperty("said_over_scatter_of_all", std::to_string(all));
    EXPECT_GT(typical, 0.67);
    EXPECT_LT(typical, 1.5);
    EXPECT_GT(all, 0.35);
    EXPECT_LT(all, 1.7);
}

/// With a wanted error, texels get rays until they meet it or have the most that is allowed; the light stays the same.
TEST(Layers, RaysFollowTheWantedError) {
    const auto baked = [](std::uint32_t rays, double error, std::uint32_t most) {
        const TemporaryFolder folder;
        BakeOptions options = small_options(sample("cornell_box"), {});
        options.unwrap.texels_per_metre = 16;
        options.rays = 1024;
        options.gather_rays = rays;
        options.error = error;
        options.most_gather_rays = most;
        options.layers = {Layer::direct, Layer::indirect, Layer::error, Layer::samples, Layer::valid};
        return read_exr_parts(bytes_of(bake_in(folder.path(), options).outputs, "scene.aov0.exr"));
    };
    constexpr double wanted = 0.05;
    const auto parts = baked(16, wanted, 1024), truth = baked(4096, 0, 4096);
    const auto light = [](const std::vector<ReadExrPart>& of, std::size_t at) {
        return static_cast<double>(of[0].floats[3 * at + 1] + of[1].floats[3 * at + 1]);
    };
    std::uint32_t least = ~0u, most = 0;
    double squares = 0, brightest = 0, count = 0, all = 0, sum = 0, true_sum = 0;
    for (std::size_t at = 0; at < parts[4].numbers.size(); ++at) brightest = std::max(brightest, light(truth, at));
    for (std::size_t at = 0; at < parts[4].numbers.size(); ++at) {
        if (parts[4].numbers[at] != 1 || light(truth, at) < 0.01 * brightest) continue;
        const std::uint32_t rays = parts[3].numbers[at];
        least = std::min(least, rays), most = std::max(most, rays);
        if (rays < 1024) {
            EXPECT_LE(static_cast<double>(parts[2].floats[at]), wanted * 1.0001);
        }
        sum += light(parts, at), true_sum += light(truth, at), ++all;
        if (static_cast<double>(parts[2].floats[at]) > wanted) continue;  // all that is allowed was not enough
        const double off = light(parts, at) / light(truth, at) - 1;
        squares += off * off, ++count;
    }
    ASSERT_GT(all, 200);
    EXPECT_GT(count / all, 0.7);
    EXPECT_LT(least, 128u) << "where light is even little is needed";
    EXPECT_GE(most, 256u);
    EXPECT_LT(std::sqrt(squares / count), 1.5 * wanted);
    EXPECT_NEAR(sum / true_sum, 1, wanted / 2) << "the light of patches has that error too";
}

/// The end of a bake whose light stage knows the parts: they are written, and sum to the lightmap.
TEST(Layers, OfLightInParts) {
    const TemporaryFolder folder;
    BakeOptions options = small_options(sample("two_rooms"), folder / "out.glb");
    for (const LayerInfo& info : all_layers) options.layers.push_back(info.layer);
    const BakeFolder work(folder / "work", options.output);
    BakeReport report;
    StageClock clock(options, report);
    const auto geometry = prepare_geometry(options, work, clock, report);

    BakedLight light;
    light.patch_irradiance.emplace();
    for (PatchNumber p = 0; p < geometry->patches.count(); ++p)
        light.patch_irradiance->emplace_back(static_cast<float>(p % 97), 2.0f, 1000.0f);
    const auto lightmap = [&](std::uint32_t page) { return page_light(options, *geometry, light, page); };
    light.texel_light = [&](std::uint32_t page) {
        std::vector<TexelLight> texels;
        for (const Rgb& sum : lightmap(page)) {
            const auto number = static_cast<std::uint32_t>(texels.size());
            texels.push_back({sum * 0.25f, sum * 0.75f, 0.01f, 0.002f, number});
        }
        return texels;
    };
    const WrittenOutputs written = write_lightmaps(options, *geometry, light, JoinedSeams(), {});
    EXPECT_TRUE(written.warnings.empty());
    for (std::uint32_t page = 0; page < geometry->atlas.page_count; ++page) {
        const std::string number = std::to_string(page);
        const auto map = read_exr_parts(read_file(folder / ("out.lightmap" + number + ".exr")));
        const auto parts = read_exr_parts(read_file(folder / ("out.aov" + number + ".exr")));
        ASSERT_EQ(parts.size(), all_layers.size());
        const auto &direct = parts[0].floats, &indirect = parts[1].floats, &error = parts[2].floats;
        const auto &samples = parts[4].numbers, &valid = parts[9].numbers;
        for (std::size_t at = 0; at < valid.size(); ++at) {
            for (std::size_t c = 0; c < 3; ++c) {
                const float expected = map.at(0).floats[3 * at + c];
                // The lightmap is in half floats.
                EXPECT_NEAR(direct[3 * at + c] + indirect[3 * at + c], expected, 1e-3f * expected + 1e-6f);
                EXPECT_NEAR(3 * direct[3 * at + c], indirect[3 * at + c], 1e-5f * indirect[3 * at + c]);
            }
            EXPECT_EQ(error[at], valid[at] == 1 ? 0.01f : 0.0f);
        }
        const PageTexels& content = geometry->texels.pages[page];
        for (std::size_t k = 0; k < content.texels.size(); ++k)
            EXPECT_EQ(samples[content.texels[k].y * std::size_t{geometry->atlas.page_size} + content.texels[k].x],
                      content.can_send(content.texels[k]) ? k : 0u);
    }

    // Where a page was not gathered in time, its layers of light are left out, and that is said.
    light.texel_light = [](std::uint32_t) { return std::vector<TexelLight>(); };
    const WrittenOutputs stopped = write_lightmaps(options, *geometry, light, JoinedSeams(), {});
    ASSERT_EQ(stopped.warnings.size(), geometry->atlas.page_count);
    EXPECT_EQ(stopped.warnings[0].code, "layers-left-out");
    EXPECT_NE(stopped.warnings[0].text.find("direct,indirect,error,sharing,samples"), std::string::npos);
    const auto others = static_cast<std::size_t>(std::ranges::count_if(all_layers, [](const LayerInfo& info) { return !info.is_of_light; }));
    EXPECT_EQ(read_exr_parts(read_file(folder / "out.aov0.exr")).size(), others);

    // Previews are quick: they have none.
    std::filesystem::remove(folder / "out.aov0.exr");
    light.state = "preview";
    write_lightmaps(options, *geometry, light, JoinedSeams(), {});
    EXPECT_FALSE(std::filesystem::exists(folder / "out.aov0.exr"));
}

}  // namespace
}  // namespace luxel::test
