// Irradiance to 8 bits and back within half a step, for any scale; PNG and EXR carry what the numbers mean.
#include "baker/output/lightmap_encode.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string_view>

namespace luxel {
namespace {

constexpr std::array encodings{LightmapEncoding::srgb8, LightmapEncoding::linear8};

double srgb_reference(double c) { return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4); }

TEST(LightmapEncode, TableIsTheStandard) {
    for (int k = 0; k < 256; ++k) {
        const auto byte = static_cast<std::uint8_t>(k);
        EXPECT_NEAR(decode_lightmap_byte(byte, LightmapEncoding::srgb8), srgb_reference(k / 255.0), 1e-14);
        EXPECT_EQ(decode_lightmap_byte(byte, LightmapEncoding::linear8), k / 255.0);
    }
    EXPECT_EQ(decode_lightmap_byte(255, LightmapEncoding::srgb8), 1.0);
}

TEST(LightmapEncode, RoundTripWithinHalfAStepAtAnyScale) {
    for (const LightmapEncoding encoding : encodings)
        for (const float scale : {1e-30f, 0.004f, 1.0f, 731.5f, 1e30f}) {
            std::vector<Rgb> values;
            for (int k = 0; k <= 3000; ++k) {
                const float share = static_cast<float>(k) / 3000.0f;
                values.emplace_back(scale * share, scale * share * share, scale * (1 - share));
            }
            const std::vector<std::uint8_t> mask(values.size(), 1);
            const EncodedPage page = encode_lightmap(values, mask, encoding);
            EXPECT_EQ(page.intensity, static_cast<double>(scale));
            for (std::size_t texel = 0; texel < values.size(); ++texel)
                for (int c = 0; c < 3; ++c) {
                    const std::uint8_t byte = page.rgb[3 * texel + static_cast<std::size_t>(c)];
                    const double share = static_cast<double>(values[texel][c]) / page.intensity;
                    const double found = decode_lightmap_byte(byte, encoding);
                    const double below =
                        byte ? decode_lightmap_byte(static_cast<std::uint8_t>(byte - 1), encoding) : found;
                    const double above =
                        byte < 255 ? decode_lightmap_byte(static_cast<std::uint8_t>(byte + 1), encoding) : found;
                    ASSERT_LE(std::abs(found - share), std::max(found - below, above - found) / 2 + 1e-15);
                    ASSERT_LE(std::abs(found - share),
                              encoding == LightmapEncoding::linear8 ? 1.0 / 510 + 1e-12 : 0.0046);
                    if (share < 0.003 && encoding == LightmapEncoding::srgb8) {
                        ASSERT_LE(std::abs(found - share), 0.00016);
                    }
                }
        }
}

TEST(LightmapEncode, NothingIsClippedAndZeroAndEmptyStayBlack) {
    const std::vector<Rgb> values{{3, 0, 1}, {100, 100, 100}, {0, 12, 0}, {-1, 0, 0}};
    const std::vector<std::uint8_t> mask{1, 0, 2, 1};
    for (const LightmapEncoding encoding : encodings) {
        const EncodedPage page = encode_lightmap(values, mask, encoding);
        EXPECT_EQ(page.intensity, 12.0) << "texels without value do not count";
        EXPECT_EQ(page.rgb[7], 255);
        EXPECT_EQ(page.rgb[1], 0);
        for (std::size_t k = 3; k < 6; ++k) EXPECT_EQ(page.rgb[k], 0);
        EXPECT_EQ(page.rgb[9], 0) << "negative values become 0";
    }
    const EncodedPage dark = encode_lightmap(std::vector<Rgb>(4, Rgb(0, 0, 0)), mask, LightmapEncoding::srgb8);
    EXPECT_EQ(dark.intensity, 1.0);
    EXPECT_EQ(dark.rgb, std::vector<std::uint8_t>(12, 0));
}

TEST(LightmapEncode, RefusesWhatIsNotANumber) {
    const std::vector<std::uint8_t> mask(1, 1);
    for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()})
        EXPECT_THROW((void)encode_lightmap(std::vector<Rgb>{{0, bad, 0}}, mask, LightmapEncoding::srgb8), Error);
    EXPECT_THROW((void)encode_lightmap(std::vector<Rgb>(2), mask, LightmapEncoding::srgb8), Error);
    EXPECT_EQ(parse_encoding("linear8"), LightmapEncoding::linear8);
    EXPECT_EQ(parse_encoding("srgb8"), LightmapEncoding::srgb8);
    EXPECT_THROW((void)parse_encoding("rgbm"), Error);
}

bool contains(const Bytes& bytes, std::string_view text) {
    return std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()).find(text) !=
           std::string_view::npos;
}

TEST(LightmapEncode, FilesKeepValuesAndMeaning) {
    std::vector<Rgb> values;
    std::vector<std::uint8_t> mask;
    for (int k = 0; k < 64 * 32; ++k) {
        values.emplace_back(static_cast<float>(k), 0.5f, 7.0f);
        mask.push_back(k % 5 ? 1 : 0);
    }
    const EncodedPage page = encode_lightmap(values, mask, LightmapEncoding::srgb8);
    const Bytes png = lightmap_png(page, LightmapEncoding::srgb8, 64, 32, "luxel 1.2.3");
    const Bytes exr = lightmap_exr(values, mask, 64, 32, "luxel 1.2.3");
    EXPECT_EQ(png, lightmap_png(page, LightmapEncoding::srgb8, 64, 32, "luxel 1.2.3"));
    EXPECT_EQ(exr, lightmap_exr(values, mask, 64, 32, "luxel 1.2.3"));
    for (const Bytes* file : {&png, &exr})
        for (const char* text : {"quantity", "irradiance", "unit", "lux", "encoding", "intensity", "luxel 1.2.3"})
            EXPECT_TRUE(contains(*file, text)) << text;
    EXPECT_TRUE(contains(png, "srgb8"));
    EXPECT_TRUE(contains(png, "2047")) << "the intensity";

    const ImagePixels from_png = decode_image(png, "png"), from_exr = decode_image(exr, "exr");
    for (std::size_t k = 0; k < values.size(); ++k) {
        const Rgb expected = mask[k] ? values[k] : Rgb(0, 0, 0);
        EXPECT_NEAR(from_exr.pixels[k][0], expected.x, expected.x * 0x1p-11f);
        EXPECT_EQ(from_exr.pixels[k][2], expected.z);
        EXPECT_NEAR(srgb_reference(from_png.pixels[k][0]) * page.intensity, expected.x, page.intensity * 0.0046);
    }
}

}  // namespace
}  // namespace luxel
