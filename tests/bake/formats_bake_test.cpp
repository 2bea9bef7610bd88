// Whole bakes in every format and profile: a reader that knows nothing but the model finds the irradiance of the float page again. And the
// unlit model shows reflectance times light.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <set>

#include "baker/output/page_picture.h"
#include "formats/base/compress.h"
#include "formats/base/file.h"
#include "formats/gltf/gltf_document.h"
#include "formats/image/image_file.h"
#include "tests/bake/whole_bake.h"
#include "tests/support/exr_parts.h"
#include "tests/support/temporary_folder.h"

namespace luxel::test {
namespace {

using nlohmann::json;

double srgb_to_linear(double c) { return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4); }

float half_to_float(std::uint16_t bits) {
    const int exponent = bits >> 10 & 31, mantissa = bits & 1023;
    return exponent ? std::ldexp(static_cast<float>(1024 + mantissa), exponent - 25) : std::ldexp(static_cast<float>(mantissa), -24);
}

using Samples = std::vector<std::array<double, 4>>;

Samples read_samples(const Bytes& file, const std::string& format) {
    Samples samples;
    if (format == "ktx2") {
        ByteCursor head(file, "ktx2");
        head.get_view(20, "kind");
        const auto width = head.get<std::uint32_t>("width"), height = head.get<std::uint32_t>("height");
        head.get_view(80 - head.at(), "head");
        const Bytes raw = decompress(ByteView(file).subspan(head.get<std::uint64_t>("level")), std::uint64_t{8} * width * height, "level");
        ByteCursor halves(raw, "level");
        samples.resize(std::size_t{width} * height);
        for (auto& sample : samples)
            for (double& value : sample) value = half_to_float(halves.get<std::uint16_t>("half"));
        return samples;
    }
    for (const auto& pixel : decode_image(file, format).pixels) samples.push_back({pixel[0], pixel[1], pixel[2], pixel[3]});
    return samples;
}

/// What docs/lightmap-formats.md says of the sample, and of the largest error of a channel.
double decode(const std::array<double, 4>& sample, std::size_t channel, const json& extras) {
    const std::string encoding = extras["encoding"];
    if (encoding == "srgb8") return srgb_to_linear(sample[channel]);
    if (encoding == "rgbm8") return sample[channel] * sample[3] * extras["range"].get<double>();
    if (encoding == "rgbm8-mx") return sample[channel] * std::pow(sample[3], 2.2) * extras["range"].get<double>();
    return sample[channel];
}

double bound(const std::string& encoding, double value, double texel, double page) {
    if (encoding == "srgb8") return 0.0092 * page;
    if (encoding == "linear8") return page / 255;
    if (encoding == "linear16") return page / 131070;
    if (encoding == "rgbm8") return (255 * texel + page) / 130050;
    if (encoding == "rgbm8-mx") return page * std::pow(std::pow(texel / page, 1 / 2.2) + 1 / 255.0, 2.2) / 510;
    return encoding == "rgbe8" ? texel / 256 : value / 2048;
}

struct Model {
    GltfDocument document;
    std::filesystem::path folder;

    explicit Model(const std::filesystem::path& path) : document(load_gltf(path)), folder(path.parent_path()) {}
    [[nodiscard]] Bytes image(std::size_t index) const {
        const json& entry = document.json["images"].at(index);
        if (entry.contains("uri")) return read_file(folder / entry["uri"].get<std::string>());
        const ByteView view = document.view(entry["bufferView"].get<std::int64_t>(), "image");
        return {view.begin(), view.end()};
    }
    /// The picture that a texture shows, by its own source or that of the extension.
    [[nodiscard]] Bytes texture(std::size_t index) const {
        const json& entry = document.json["textures"].at(index);
        if (entry.contains("source")) return image(entry["source"]);
        return image((*entry["extensions"].begin())["source"]);
    }
    /// Of materials by MOZ_lightmap, of nodes by MX_lightmap: { index, intensity, extras, of }, `of` the name of the material or node.
    [[nodiscard]] std::vector<json> lightmaps() const {
        std::vector<json> found;
        for (const auto& [list, extension] : {std::pair{"materials", "MOZ_lightmap"}, std::pair{"nodes", "MX_lightmap"}})
            for (const json& entry : document.json[list]) {
                if (!entry.contains("extensions") || !entry["extensions"].contains(extension)) continue;
                json use = entry["extensions"][extension];
                if (use.contains("lightMapTexture")) use["index"] = use["lightMapTexture"]["index"];
                use["of"] = entry["name"];
                found.push_back(std::move(use));
            }
        return found;
    }
    [[nodiscard]] json lightmap_of(const std::string& name) const {
        json found;
        for (const json& use : lightmaps())
            if (use["of"] == name) found = use;
        return found;
    }
};

/// Every lightmap of the model, read as its extras say, gives the float page of the report.
void expect_irradiance(const BakeOptions& options, const BakeReport& report) {
    const Model model(options.output);
    const auto pages = lightmap_pages(report);
    ASSERT_EQ(pages.size(), 1u) << "so that it is clear which page a material means";
    double largest = 0;
    for (const auto& pixel : pages[0].pixels)
        for (std::size_t c = 0; c < 3; ++c) largest = std::max(largest, static_cast<double>(pixel[c]));
    const std::vector<json> uses = model.lightmaps();
    for (const json& use : uses) {
        const json& extras = use["extras"];
        const Samples samples = read_samples(model.texture(use["index"]), extras["format"]);
        ASSERT_EQ(samples.size(), pages[0].pixels.size());
        const double scale = use["intensity"].get<double>() * extras["irradianceFactor"].get<double>();
        for (std::size_t k = 0; k < samples.size(); ++k) {
            const auto& truth = pages[0].pixels[k];
            const auto texel = static_cast<double>(std::max({truth[0], truth[1], truth[2]}));
            for (std::size_t c = 0; c < 3; ++c) {
                const auto value = static_cast<double>(truth[c]);
                // The float page is rounded to halves; single precision on the way.
                ASSERT_NEAR(decode(samples[k], c, extras) * scale, value, bound(extras["encoding"], value, texel, largest) + value * 0x1p-11 + 1e-7 * largest)
                    << extras.dump() << " texel " << k;
            }
        }
    }
    EXPECT_GT(uses.size(), 3u);
}

/// One bake folder for all: only the writing is repeated.
BakeOptions formats_options(const TemporaryFolder& folder, const std::filesystem::path& input) {
    BakeOptions options = small_options(input, folder / "out" / "scene.glb");
    options.unwrap.page_size = 256;
    options.work = folder / "work";
    options.gather_rays = 0;
    return options;
}

TEST(FormatsBake, ModelsAreReadBackInEveryFormat) {
    const TemporaryFolder folder;
    for (const LightmapFormatInfo& info : all_lightmap_formats)
        for (const char* ending : {".glb", ".gltf"}) {
            SCOPED_TRACE(std::string(info.name) + ending);
            BakeOptions options = formats_options(folder, sample("two_rooms"));
            options.format = info.format;
            options.output = folder / info.name / (std::string("scene") + ending);
            const BakeReport report = bake(options);
            expect_irradiance(options, report);
            const json page = json::parse(std::ifstream(options.output.string() + ".lightmaps.json"))["pages"][0];
            EXPECT_EQ(page["picture"]["format"], info.name);
            EXPECT_EQ(page["picture"].contains("uri"), std::string(ending) == ".gltf" || info.texture_extension != nullptr);
            if (page["picture"].contains("uri")) {
                EXPECT_TRUE(std::filesystem::exists(options.output.parent_path() / page["picture"]["uri"].get<std::string>()));
            }
            EXPECT_TRUE(std::filesystem::exists(folder / info.name / "scene.lightmap0.exr")) << "the truth is there in every case";
            EXPECT_EQ(std::ranges::count_if(report.outputs, [](const OutputReport& output) { return output.error.has_value(); }), 1);
        }
}

TEST(FormatsBake, LinearBytesToo) {
    const TemporaryFolder folder;
    BakeOptions options = formats_options(folder, sample("two_rooms"));
    options.encoding = LightmapEncoding::linear8;
    expect_irradiance(options, bake(options));
    EXPECT_EQ(Model(options.output).lightmap_of("wall_3")["extras"]["encoding"], "linear8");
}

TEST(FormatsBake, ProfilesDifferInTheFactorPiAlone) {
    const TemporaryFolder folder;
    const auto input = edited_sample("two_rooms", folder / "in", [](json& document) {
        for (json& material : document["materials"])
            if (material["name"] == "ceiling") material["extensions"]["KHR_materials_unlit"] = json::object();
        document["extensionsUsed"].push_back("KHR_materials_unlit");
    });
    std::map<std::string, json> lit, unlit;
    for (const ViewerProfileInfo& info : all_viewer_profiles) {
        SCOPED_TRACE(info.name);
        BakeOptions options = formats_options(folder, input);
        options.output = folder / info.name / "scene.glb";
        options.profile = info.profile;
        options.format = info.format;
        options.encoding = info.byte_encoding;
        expect_irradiance(options, bake(options));
        const Model model(options.output);
        lit[info.name] = model.lightmap_of(info.on_nodes ? "room_0_0_floor" : "wall_3"), unlit[info.name] = model.lightmap_of("ceiling");
        EXPECT_EQ(lit[info.name]["extras"]["profile"], info.name);
        EXPECT_EQ(json::parse(std::ifstream(options.output.string() + ".lightmaps.json"))["profile"], info.name);
    }
    const auto intensity = [](const json& use) { return use["intensity"].get<double>(); };
    EXPECT_DOUBLE_EQ(intensity(unlit["three"]), intensity(lit["three"]));
    EXPECT_DOUBLE_EQ(intensity(lit["plain"]) * M_PI, intensity(lit["three"]));
    EXPECT_DOUBLE_EQ(intensity(unlit["plain"]), intensity(lit["plain"]));
    EXPECT_DOUBLE_EQ(intensity(unlit["hubs"]) * M_PI, intensity(lit["hubs"]));
    EXPECT_EQ(lit["hubs"]["extras"]["encoding"], "rgbe8");
    // The largest code of rgbm-mx is its range.
    EXPECT_NEAR(intensity(lit["mx"]) * 34.49 * M_PI, intensity(lit["three"]), 1e-6 * intensity(lit["three"]));
    EXPECT_EQ(lit["mx"]["extras"]["encoding"], "rgbm8-mx");
}

TEST(FormatsBake, NodesNameTheLightmapForMx) {
    const TemporaryFolder folder;
    BakeOptions options = formats_options(folder, sample("two_rooms"));
    options.profile = ViewerProfile::mx;
    options.format = LightmapFormat::rgbm_mx;
    bake(options);
    const GltfDocument input = load_gltf(options.input);
    const Model model(options.output);
    EXPECT_EQ(model.document.json["materials"], input.json["materials"]);
    std::size_t with_mesh = 0;
    for (const json& node : model.document.json["nodes"]) with_mesh += node.contains("mesh");
    EXPECT_EQ(model.lightmaps().size(), with_mesh);
    const json sidecar = json::parse(std::ifstream(options.output.string() + ".lightmaps.json"));
    EXPECT_EQ(sidecar["profile"], "mx");
    EXPECT_EQ(sidecar["pages"][0]["picture"]["encoding"], "rgbm8-mx");
    EXPECT_EQ(sidecar["pages"][0]["picture"]["range"], 34.49);
}

TEST(FormatsBake, HubsGetsOneFile) {
    const TemporaryFolder folder;
    BakeOptions options = formats_options(folder, sample("two_rooms"));
    options.profile = ViewerProfile::hubs;
    options.format = LightmapFormat::rgbe;
    bake(options);
    EXPECT_FALSE(std::filesystem::exists(folder / "out" / "scene.lightmap0.hdr"));
    const Model model(options.output);
    const json& image = model.document.json["images"].back();
    EXPECT_EQ(image["mimeType"], "image/vnd.radiance");
    EXPECT_TRUE(image.contains("bufferView"));
}

TEST(FormatsBake, UnlitModelShowsReflectanceTimesLight) {
    const TemporaryFolder folder;
    BakeOptions options = formats_options(folder, sample("two_rooms"));
    options.layers = {Layer::albedo, Layer::valid};
    options.unlit = true;
    const BakeReport report = bake(options);
    ASSERT_TRUE(report.unlit);
    EXPECT_LE(report.unlit->cut_share, 0.01);
    const Model model(folder / "out" / "scene.unlit.glb");
    EXPECT_EQ(model.document.json["extensionsUsed"].back(), "KHR_materials_unlit");

    const auto layers = read_exr_parts(read_file(folder / "out" / "scene.aov0.exr"));
    const auto& albedo = layers[0].floats;
    const auto pages = lightmap_pages(report);
    std::set<std::string> shown;
    for (const json& mesh : model.document.json["meshes"])
        for (const json& primitive : mesh["primitives"]) {
            const json& material = model.document.json["materials"].at(primitive["material"].get<std::size_t>());
            EXPECT_TRUE(material["extensions"].contains("KHR_materials_unlit"));
            EXPECT_EQ(material["pbrMetallicRoughness"]["baseColorTexture"]["texCoord"], 1);
            shown.insert(material["name"].get<std::string>());
            EXPECT_TRUE(primitive["attributes"].contains("TEXCOORD_1"));
        }
    EXPECT_TRUE(shown.contains("lamp_0"));

    const Samples samples = read_samples(model.image(0), "png");
    std::size_t compared = 0, white = 0;
    for (std::size_t k = 0; k < samples.size(); ++k) {
        if (albedo[3 * k] + albedo[3 * k + 1] + albedo[3 * k + 2] == 0) continue;
        ++compared;
        // The lamp itself, of grey 0.5, sends light of its own: far above white.
        const bool is_lamp = albedo[3 * k] == 0.5f && albedo[3 * k + 1] == 0.5f && albedo[3 * k + 2] == 0.5f;
        for (std::size_t c = 0; c < 3; ++c) {
            const double nits = static_cast<double>(albedo[3 * k + c]) * static_cast<double>(pages[0].pixels[k][c]) / M_PI;
            const double share = std::min(1.0, nits * report.unlit->exposure);
            if (is_lamp) ASSERT_EQ(samples[k][c], 1.0);
            else ASSERT_NEAR(srgb_to_linear(samples[k][c]), share, 0.0093 + 0.001 * share) << k;
            white += samples[k][c] == 1.0;
        }
    }
    EXPECT_GT(compared, 1000u);
    EXPECT_LE(static_cast<double>(white), 0.02 * 3 * static_cast<double>(compared));
}

TEST(FormatsBake, ExposureOfTheUnlitModelIsTheUsers) {
    const TemporaryFolder folder;
    BakeOptions options = formats_options(folder, sample("furnace"));
    options.unlit = true;
    options.unlit_exposure = 0.25;
    const BakeReport report = bake(options);
    EXPECT_EQ(report.unlit->exposure, 0.25);
    // A closed room of M = 1 lm/m2 and reflectance 0.5: B = 2 lm/m2, which is 2 / pi nits.
    const Samples samples = read_samples(Model(folder / "out" / "scene.unlit.glb").image(0), "png");
    std::size_t lit = 0;
    double sum = 0;
    for (const auto& sample : samples)
        if (sample[0] > 0) ++lit, sum += srgb_to_linear(sample[0]);
    ASSERT_GT(lit, 100u);
    EXPECT_NEAR(sum / static_cast<double>(lit), 0.25 * 2 / M_PI, 0.01 * 0.25 * 2 / M_PI);
}

TEST(FormatsBake, MasksStayInTheUnlitModel) {
    const TemporaryFolder folder;
    BakeOptions options = formats_options(folder, sample("fence"));
    options.unlit = true;
    options.unwrap.texels_per_metre = 16;
    bake(options);
    const Model model(folder / "out" / "scene.unlit.glb");
    std::size_t masked = 0;
    for (const json& mesh : model.document.json["meshes"])
        for (const json& primitive : mesh["primitives"]) {
            const json& material = model.document.json["materials"].at(primitive["material"].get<std::size_t>());
            masked += material.value("alphaMode", "OPAQUE") == "MASK";
        }
    EXPECT_GT(masked, 0u);
    std::set<int> alphas;
    const json& images = model.document.json["images"];
    for (std::size_t k = 0; k < images.size(); ++k)
        if (images[k].value("name", "").starts_with("unlit"))
            for (const auto& sample : read_samples(model.image(k), "png")) alphas.insert(static_cast<int>(std::lround(255 * sample[3])));
    EXPECT_TRUE(alphas.contains(255));
    EXPECT_TRUE(alphas.contains(0)) << "holes, and what is outside of all charts";
    EXPECT_GT(alphas.size(), 2u) << "edges of the pattern";
}

}  // namespace
}  // namespace luxel::test
