// Every format of a page, read back from its file: within its bound in closed form, also over six decades of light, and the error that is
// reported is the one that there is.
#include "baker/output/page_picture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "baker/core/parallel.h"
#include "baker/output/ordered_dither.h"
#include "baker/output/texel_codes.h"
#include "formats/base/compress.h"
#include "formats/image/image_file.h"

namespace luxel {
namespace {

constexpr std::uint32_t width = 96, height = 64;
constexpr std::size_t texels = width * height;

struct Page {
    std::vector<Rgb> values;
    std::vector<std::uint8_t> mask;
    float largest = 0;
};

/// Light over `decades` below `largest`, which one texel has; a fifth of the texels has no value.
Page page_of(double decades, float largest) {
    Page page{{}, {}, largest};
    std::mt19937 random(3);
    std::uniform_real_distribution<double> uniform(0, 1);
    for (std::size_t k = 0; k < texels; ++k) {
        const double size = static_cast<double>(largest) * std::pow(10.0, -decades * uniform(random));
        page.values.emplace_back(static_cast<float>(size * uniform(random)), static_cast<float>(size * uniform(random)), static_cast<float>(size));
        page.mask.push_back(k % 5 != 4);
    }
    page.values[0] = Rgb(0, 0, 0);
    page.values[1] = Rgb(largest, largest, largest);
    return page;
}

PagePictureOptions options_of(LightmapFormat format, bool dither = true, LightmapEncoding encoding = LightmapEncoding::srgb8) {
    return {format, encoding, dither, "luxel 9.9.9"};
}

double srgb_to_linear(double c) { return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4); }

float half_to_float(std::uint16_t bits) {
    const int exponent = bits >> 10 & 31, mantissa = bits & 1023;
    return exponent ? std::ldexp(static_cast<float>(1024 + mantissa), exponent - 25) : std::ldexp(static_cast<float>(mantissa), -24);
}

/// Samples before the intensity, from the bytes of the file, by what its document says.
std::vector<TexelValues> read_back(const PagePicture& picture, const PagePictureOptions& options) {
    std::vector<TexelValues> out(texels);
    if (options.format == LightmapFormat::ktx2) {
        ByteCursor cursor(picture.file, "ktx2");
        cursor.get_view(80, "header");
        const auto at = cursor.get<std::uint64_t>("level");
        const Bytes raw = decompress(ByteView(picture.file).subspan(at), texels * 8, "level");
        ByteCursor halves(raw, "level");
        for (TexelValues& texel : out) {
            for (double& value : texel) value = half_to_float(halves.get<std::uint16_t>("half"));
            EXPECT_EQ(halves.get<std::uint16_t>("alpha"), 0x3c00);
        }
        return out;
    }
    const ImagePixels image = decode_image(picture.file, "picture");
    EXPECT_EQ(image.pixels.size(), texels);
    for (std::size_t k = 0; k < texels; ++k)
        for (std::size_t c = 0; c < 3; ++c) {
            const auto sample = static_cast<double>(image.pixels[k][c]);
            if (options.format == LightmapFormat::rgbm) out[k][c] = sample * static_cast<double>(image.pixels[k][3]) * picture.range;
            else if (options.format == LightmapFormat::rgbm_mx) out[k][c] = sample * std::pow(static_cast<double>(image.pixels[k][3]), 2.2) * picture.range;
            else if (options.format == LightmapFormat::png8 && options.encoding == LightmapEncoding::srgb8) out[k][c] = srgb_to_linear(sample);
            else out[k][c] = sample;
        }
    return out;
}

/// The bound of a channel's error as the documents state it.
double bound_of(const PagePictureOptions& options, const PagePicture& picture, const Page& page, const Rgb& texel, double value) {
    const double largest = static_cast<double>(page.largest), brightest = static_cast<double>(std::max({texel.x, texel.y, texel.z}));
    switch (options.format) {
        case LightmapFormat::png8:
            return largest * (options.encoding == LightmapEncoding::linear8 ? 1.0 / 510 : 0.0046) * (options.dither ? 2 : 1);
        case LightmapFormat::png16:
            return largest / 131070;
        case LightmapFormat::rgbm:
            return (255 * brightest + largest) / 130050;
        case LightmapFormat::rgbm_mx:
            return largest * std::pow(std::pow(brightest / largest, 1 / 2.2) + 1 / 255.0, 2.2) / 510;
        case LightmapFormat::rgbe:
            return brightest / 256;
        case LightmapFormat::exr:
        case LightmapFormat::ktx2:
            return std::max(value * 0x1p-11, picture.intensity * 0x1p-25);
    }
    return 0;
}

std::vector<PagePictureOptions> all_options() {
    std::vector<PagePictureOptions> all;
    for (const LightmapFormatInfo& info : all_lightmap_formats) all.push_back(options_of(info.format));
    all.push_back(options_of(LightmapFormat::png8, false));
    all.push_back(options_of(LightmapFormat::png8, true, LightmapEncoding::linear8));
    all.push_back(options_of(LightmapFormat::png8, false, LightmapEncoding::linear8));
    return all;
}

std::string name_of(const PagePictureOptions& options) {
    return std::string(lightmap_format_info(options.format).name) + " " + encoding_of(options.format, options.encoding) + (options.format == LightmapFormat::png8 && options.dither ? " dithered" : "");
}

TEST(PagePicture, EveryFormatIsWithinItsBound) {
    for (const double decades : {0.5, 2.0, 6.0})
        for (const float largest : {731.25f, 3e-9f, 2e30f}) {
            const Page page = page_of(decades, largest);
            for (const PagePictureOptions& options : all_options()) {
                const PagePicture picture = page_picture(page.values, page.mask, width, height, options);
                const auto samples = read_back(picture, options);
                for (std::size_t k = 0; k < texels; ++k)
                    for (int c = 0; c < 3; ++c) {
                        const double decoded = samples[k][static_cast<std::size_t>(c)] * picture.intensity;
                        const double value = page.mask[k] ? static_cast<double>(page.values[k][c]) : 0;
                        const double float_steps = 3e-7 * value;  // reading divides by 255 in single precision
                        ASSERT_LE(std::abs(decoded - value), bound_of(options, picture, page, page.values[k], value) + float_steps)
                            << name_of(options) << ", " << decades << " decades below " << largest << ", value " << value;
                    }
            }
        }
}

TEST(PagePicture, TheErrorSaidIsTheErrorThere) {
    const Page page = page_of(6, 731.25f);
    const ImagePixels truth = decode_image(lightmap_exr(page.values, page.mask, width, height, "luxel"), "truth");
    for (const PagePictureOptions& options : all_options()) {
        const PagePicture picture = page_picture(page.values, page.mask, width, height, options);
        const auto samples = read_back(picture, options);
        std::vector<double> relative;
        double largest = 0;
        for (std::size_t k = 0; k < texels; ++k) {
            double error = 0, brightest = 0;
            for (std::size_t c = 0; c < 3; ++c) {
                const auto value = static_cast<double>(truth.pixels[k][c]);
                error = std::max(error, std::abs(samples[k][c] * picture.intensity - value));
                brightest = std::max(brightest, value);
            }
            largest = std::max(largest, error / static_cast<double>(page.largest));
            if (brightest > 0) relative.push_back(error / brightest);
        }
        std::ranges::sort(relative);
        const double median = relative[(relative.size() + 1) / 2 - 1], p95 = relative[static_cast<std::size_t>(std::ceil(0.95 * static_cast<double>(relative.size()))) - 1];
        EXPECT_NEAR(picture.error.median, median, 1e-6 + 1e-5 * median) << name_of(options);
        EXPECT_NEAR(picture.error.p95, p95, 1e-6 + 1e-5 * p95) << name_of(options);
        EXPECT_NEAR(picture.error.largest, largest, 1e-6) << name_of(options);
        std::printf("%-26s median %.3g, 95 %% %.3g, largest %.3g, %zu bytes\n", name_of(options).c_str(), median, p95, largest, picture.file.size());
    }
}

TEST(PagePicture, HalvesThatHoldThePageAreTheTruth) {
    const Page page = page_of(2, 500);
    for (const LightmapFormat format : {LightmapFormat::exr, LightmapFormat::ktx2}) {
        const PagePicture picture = page_picture(page.values, page.mask, width, height, options_of(format));
        EXPECT_EQ(picture.intensity, 1);
        EXPECT_EQ(picture.error.largest, 0);
    }
}

TEST(PagePicture, SameBytesForAnyThreadCount) {
    const Page page = page_of(4, 90);
    for (const PagePictureOptions& options : all_options()) {
        Bytes first;
        for (const unsigned threads : {1u, 2u, 5u}) {
            const ThreadLimit limit(threads);
            const Bytes file = page_picture(page.values, page.mask, width, height, options).file;
            if (first.empty()) first = file;
            EXPECT_EQ(file, first) << name_of(options);
        }
    }
}

TEST(PagePicture, DarkAndBrokenPages) {
    const std::vector<std::uint8_t> mask(4, 1);
    for (const PagePictureOptions& options : all_options()) {
        const PagePicture dark = page_picture(std::vector<Rgb>(4, Rgb(0, 0, 0)), mask, 2, 2, options);
        EXPECT_EQ(dark.error.median, 0);
        EXPECT_EQ(dark.error.largest, 0);
        EXPECT_GT(dark.intensity, 0);
        EXPECT_THROW((void)page_picture(std::vector<Rgb>(4, Rgb(0, NAN, 0)), mask, 2, 2, options), Error);
        EXPECT_THROW((void)page_picture(std::vector<Rgb>(4, Rgb(0, 0, 0)), mask, 2, 3, options), Error);
    }
}

TEST(Dither, MeanOfAnEvenSurfaceIsItsLight) {
    constexpr std::uint32_t side = 64;
    const std::vector<std::uint8_t> mask(std::size_t{side} * side, 1);
    for (const LightmapEncoding encoding : {LightmapEncoding::srgb8, LightmapEncoding::linear8})
        for (const float share : {0.00007f, 0.0031f, 0.1f, 0.3337f, 0.72f, 0.999f}) {
            std::vector<Rgb> values(mask.size(), Rgb(share, share / 2, share / 3));
            values[0] = Rgb(1, 1, 1);
            const EncodedPage page = encode_lightmap(values, mask, encoding, side);
            for (std::size_t c = 0; c < 3; ++c) {
                double sum = 0;
                std::uint8_t low = 255, high = 0;
                for (std::size_t k = 1; k < values.size(); ++k) {
                    const std::uint8_t byte = page.rgb[3 * k + c];
                    sum += decode_lightmap_byte(byte, encoding);
                    low = std::min(low, byte), high = std::max(high, byte);
                }
                const double mean = sum / static_cast<double>(values.size() - 1), wanted = static_cast<double>(values[1][static_cast<int>(c)]);
                ASSERT_LE(high - low, 1) << "one of the two neighbours";
                const double step = decode_lightmap_byte(high, encoding) - decode_lightmap_byte(low, encoding);
                // The discrepancy of the lattice: 4095 thresholds; a plain rounding is off by up to half a step.
                EXPECT_NEAR(mean, wanted, 0.005 * step + 1e-9) << share << " " << encoding_name(encoding);
            }
        }
}

TEST(Dither, ExactValuesStay) {
    std::vector<Rgb> values;
    for (int byte = 0; byte < 256; ++byte)
        for (int k = 0; k < 16; ++k) values.emplace_back(static_cast<float>(byte), 0, 255);
    const std::vector<std::uint8_t> mask(values.size(), 1);
    const EncodedPage page = encode_lightmap(values, mask, LightmapEncoding::linear8, 64);
    for (std::size_t k = 0; k < values.size(); ++k) {
        ASSERT_EQ(page.rgb[3 * k], k / 16);
        ASSERT_EQ(page.rgb[3 * k + 1], 0);
        ASSERT_EQ(page.rgb[3 * k + 2], 255);
    }
}

TEST(Dither, ThresholdsAreSpreadEvenlyInEveryNeighbourhood) {
    for (std::uint32_t top = 0; top < 500; top += 97) {
        std::vector<double> thresholds;
        for (std::uint32_t y = 0; y < 8; ++y)
            for (std::uint32_t x = 0; x < 8; ++x) thresholds.push_back(dither_threshold(top + x, 2 * top + y));
        std::ranges::sort(thresholds);
        EXPECT_GT(thresholds.front(), 0);
        EXPECT_LT(thresholds.back(), 1);
        for (std::size_t k = 0; k < 64; ++k) EXPECT_NEAR(thresholds[k], (static_cast<double>(k) + 0.5) / 64, 3.0 / 64);
    }
}

}  // namespace
}  // namespace luxel
