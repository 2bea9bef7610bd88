// Kinds of PNG, JPEG and OpenEXR that other programs write: values as stored, damage is refused, and none of them loads the module.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "formats/image/image_file.h"
#include "tests/support/sample_pictures.h"

namespace luxel {
namespace {

using namespace test;

constexpr std::uint32_t width = 21, height = 13;
constexpr std::size_t pixel_count = std::size_t{width} * height;

bool is_refused(const Bytes& bytes, const ImageLimits& limits = {}) {
    try {
        (void)decode_image(bytes, "picture", limits);
    } catch (const Error& error) {
        EXPECT_EQ(error.code, ErrorCode::bad_input) << error.what();
        return true;
    }
    return false;
}

PngSample png_sample(PngColour colour, int bits, std::size_t channels) {
    PngSample sample{.width = width, .height = height, .colour = colour, .bits = bits};
    const unsigned largest = (1u << bits) - 1;
    for (std::size_t k = 0; k < pixel_count * channels; ++k)
        sample.samples.push_back(static_cast<std::uint16_t>((k * 40503 + k / 7) & largest));
    return sample;
}

TEST(PictureKinds, PngOfAllDepthsInterlacedOrNot) {
    for (const bool is_interlaced : {false, true})
        for (const auto& [colour, bits, channels] :
             {std::tuple{PngColour::grey, 1, 1u}, {PngColour::grey, 2, 1u}, {PngColour::grey, 4, 1u}, {PngColour::grey, 8, 1u},
              {PngColour::grey, 16, 1u}, {PngColour::grey_alpha, 8, 2u}, {PngColour::grey_alpha, 16, 2u}, {PngColour::rgb, 8, 3u},
              {PngColour::rgb, 16, 3u}, {PngColour::rgba, 8, 4u}, {PngColour::rgba, 16, 4u}}) {
            PngSample sample = png_sample(colour, bits, channels);
            sample.is_interlaced = is_interlaced;
            const ImagePixels image = decode_image(make_png(sample), "png");
            ASSERT_EQ(image.pixels.size(), pixel_count);
            EXPECT_EQ(image.width, width);
            EXPECT_FALSE(image.is_float);
            const bool has_alpha = channels % 2 == 0;
            const auto largest = static_cast<float>((1u << bits) - 1);
            for (std::size_t k = 0; k < pixel_count; ++k)
                for (std::size_t c = 0; c < 4; ++c) {
                    const std::size_t from = c == 3 ? channels - 1 : channels < 3 ? 0 : c;
                    const float expected = c == 3 && !has_alpha ? 1.0f : static_cast<float>(sample.samples[k * channels + from]) / largest;
                    ASSERT_NEAR(image.pixels[k][c], expected, 1e-7f) << bits << " bits, " << channels << " channels, pixel " << k;
                }
        }
}

TEST(PictureKinds, PngPaletteWithTransparency) {
    PngSample sample = png_sample(PngColour::palette, 2, 1);
    sample.palette = {{255, 0, 0}, {0, 255, 0}, {10, 20, 30}, {1, 2, 3}};
    sample.palette_alpha = {0, 128};
    const ImagePixels image = decode_image(make_png(sample), "png");
    for (std::size_t k = 0; k < pixel_count; ++k) {
        const std::size_t index = sample.samples[k];
        for (std::size_t c = 0; c < 3; ++c) ASSERT_NEAR(image.pixels[k][c], static_cast<float>(sample.palette[index][c]) / 255, 1e-7f);
        ASSERT_NEAR(image.pixels[k][3], index == 0 ? 0 : index == 1 ? 128.0f / 255 : 1, 1e-7f);
    }
}

TEST(PictureKinds, PngColourThatIsNotThere) {
    for (const int bits : {8, 16}) {
        PngSample sample = png_sample(PngColour::rgb, bits, 3);
        sample.transparent = {sample.samples[30], sample.samples[31], sample.samples[32]};
        const ImagePixels image = decode_image(make_png(sample), "png");
        EXPECT_EQ(image.pixels[10][3], 0.0f);
        EXPECT_EQ(image.pixels[11][3], 1.0f);
    }
}

TEST(PictureKinds, DamagedPngIsRefused) {
    PngSample sample = png_sample(PngColour::palette, 4, 1);
    sample.palette.resize(16, {7, 8, 9});
    sample.palette_alpha.assign(16, 100);
    const Bytes whole = make_png(sample);
    EXPECT_FALSE(is_refused(whole));
    for (std::size_t size = 8; size < whole.size(); ++size)
        EXPECT_TRUE(is_refused({whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)})) << size;
    for (std::size_t at = 8; at < whole.size(); ++at) {
        Bytes flipped = whole;
        flipped[at] ^= 1;
        EXPECT_TRUE(is_refused(flipped)) << "byte " << at;
    }
}

/// Smooth, so that compression keeps it nearly.
std::vector<std::uint8_t> smooth(std::uint32_t columns, std::uint32_t rows, std::size_t channels) {
    std::vector<std::uint8_t> samples;
    for (std::uint32_t y = 0; y < rows; ++y)
        for (std::uint32_t x = 0; x < columns; ++x)
            for (std::size_t c = 0; c < channels; ++c) samples.push_back(static_cast<std::uint8_t>(40 + x + 2 * y + 30 * c));
    return samples;
}

TEST(PictureKinds, JpegGreyColourProgressive) {
    for (const auto& [colour, channels] : {std::pair{JpegColour::grey, 1u}, {JpegColour::full, 3u}, {JpegColour::halved, 3u}})
        for (const bool is_progressive : {false, true}) {
            const std::vector<std::uint8_t> samples = smooth(45, 29, channels);
            const ImagePixels image = decode_image(make_jpeg(45, 29, colour, is_progressive, samples), "jpeg");
            ASSERT_EQ(image.pixels.size(), 45u * 29u);
            EXPECT_FALSE(image.is_float);
            for (std::size_t k = 0; k < image.pixels.size(); ++k) {
                for (std::size_t c = 0; c < 3; ++c)
                    ASSERT_NEAR(image.pixels[k][c], static_cast<float>(samples[k * channels + (channels == 1 ? 0 : c)]) / 255, 0.02f);
                ASSERT_EQ(image.pixels[k][3], 1.0f);
            }
        }
}

/// Some programs leave bytes between the parts of a file. They change nothing.
TEST(PictureKinds, JpegWithStrayBytesIsRead) {
    const Bytes clean = make_jpeg(45, 29, JpegColour::halved, false, smooth(45, 29, 3));
    Bytes stray = clean;
    stray.insert(stray.end() - 2, {0x11, 0x22, 0x33});  // before the end of image
    const ImagePixels expected = decode_image(clean, "clean"), found = decode_image(stray, "stray");
    EXPECT_EQ(found.pixels, expected.pixels);
}

TEST(PictureKinds, TruncatedJpegIsRefused) {
    for (const bool is_progressive : {false, true}) {
        const Bytes whole = make_jpeg(45, 29, JpegColour::halved, is_progressive, smooth(45, 29, 3));
        EXPECT_FALSE(is_refused(whole));
        for (std::size_t size = 3; size < whole.size(); ++size)
            EXPECT_TRUE(is_refused({whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)})) << size << " of " << whole.size();
    }
}

std::vector<float> some_values(std::size_t channels) {
    std::vector<float> values(pixel_count * channels);
    for (std::size_t k = 0; k < values.size(); ++k) values[k] = static_cast<float>(k % 1000) / 64;  // halves and whole numbers hold them
    return values;
}

void expect_channels(const ImagePixels& image, const std::vector<float>& values, std::size_t channels, std::array<int, 4> places) {
    ASSERT_EQ(image.width, width);
    ASSERT_EQ(image.height, height);
    for (std::size_t k = 0; k < pixel_count; ++k)
        for (std::size_t c = 0; c < 4; ++c)
            ASSERT_EQ(image.pixels[k][c], places[c] < 0 ? 1.0f : values[k * channels + static_cast<std::size_t>(places[c])])
                << k << ", " << c;
}

TEST(PictureKinds, ExrScanLinesAndTilesWithTheWindowAnywhere) {
    for (const ExrKind kind : {ExrKind::half_float, ExrKind::float_32})
        for (const auto& [left, top] : {std::pair{0, 0}, {-30, 5}, {7, -100}, {1000000000, -1000000000}})
            for (const auto& [tile_width, tile_height, has_levels] :
                 {std::tuple{0u, 0u, false}, {8u, 8u, false}, {64u, 4u, false}, {8u, 8u, true}}) {
                ExrSamplePart part{
                    "", {{"R", kind}, {"G", kind}, {"B", kind}}, left, top, tile_width, tile_height, has_levels, some_values(3)};
                const ImagePixels image = decode_image(make_exr(width, height, {part}), "exr");
                EXPECT_TRUE(image.is_float);
                expect_channels(image, part.values, 3, {0, 1, 2, -1});
            }
}

TEST(PictureKinds, ExrChannelsByNameElseByOrder) {
    const auto half = ExrKind::half_float;
    const auto decoded = [&](const std::vector<std::string>& names) {
        ExrSamplePart part;
        for (const std::string& name : names) part.channels.emplace_back(name, half);
        part.values = some_values(names.size());
        return decode_image(make_exr(width, height, {part}), "exr");
    };
    expect_channels(decoded({"B", "A", "depth.Z", "G", "R"}), some_values(5), 5, {4, 3, 0, 1});
    expect_channels(decoded({"light.B", "light.G", "light.R"}), some_values(3), 3, {2, 1, 0, -1});
    expect_channels(decoded({"Z", "Y", "X"}), some_values(3), 3, {2, 1, 0, -1});
    expect_channels(decoded({"A", "Y"}), some_values(2), 2, {1, 1, 1, 0});
    expect_channels(decoded({"Y"}), some_values(1), 1, {0, 0, 0, -1});
}

TEST(PictureKinds, ExrWholeNumbersAreShares) {
    ExrSamplePart part{.channels = {{"Y", ExrKind::uint_32}}, .values = some_values(1)};
    part.values[0] = 0x1p31f;
    const ImagePixels image = decode_image(make_exr(width, height, {part}), "exr");
    EXPECT_FALSE(image.is_float);
    EXPECT_NEAR(image.pixels[0][1], 0.5, 1e-6);
    EXPECT_NEAR(image.pixels[200][2] * 0x1p32, std::floor(200.0 / 64), 1e-6);
}

TEST(PictureKinds, OfSeveralExrPartsTheFirstIsRead) {
    const auto part = [](const char* name, std::uint32_t tile) {
        return ExrSamplePart{
            name,          {{"R", ExrKind::float_32}, {"G", ExrKind::half_float}, {"B", ExrKind::float_32}}, 3, 4, tile, tile, false,
            some_values(3)};
    };
    ExrSamplePart other = part("other", 8);
    for (float& value : other.values) value += 1000;
    for (const std::uint32_t tile : {0u, 16u})
        expect_channels(decode_image(make_exr(width, height, {part("first", tile), other}), "exr"), some_values(3), 3, {0, 1, 2, -1});
}

std::size_t place_of(const Bytes& bytes, std::string_view text) {
    return std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()).find(text);
}

TEST(PictureKinds, ExrHeadThatClaimsTooMuchIsRefused) {
    const Bytes whole =
        make_exr(width, height, {{.channels = {{"Y", ExrKind::half_float}}, .tile_width = 8, .tile_height = 8, .values = some_values(1)}});
    const auto with = [&](std::string_view attribute, std::size_t offset, std::uint32_t number) {
        Bytes changed = whole;
        const std::size_t at = place_of(whole, attribute) + attribute.size() + offset;
        for (std::size_t k = 0; k < 4; ++k) changed.at(at + k) = static_cast<std::uint8_t>(number >> 8 * k);
        return changed;
    };
    constexpr std::string_view type("type\0string\0", 12), tiles("tiles\0tiledesc\0", 15), window("dataWindow\0box2i\0", 17);
    ASSERT_FALSE(is_refused(with(type, 0, 10)));
    EXPECT_TRUE(is_refused(with(type, 0, 0x7fffffff))) << "size of an attribute";
    EXPECT_TRUE(is_refused(with(type, 0, 0xffffffff)));
    EXPECT_TRUE(is_refused(with(tiles, 0, 1000))) << "a size that is not the one of its type";
    EXPECT_TRUE(is_refused(with(tiles, 4, 0x40000000))) << "width of tiles";
    EXPECT_TRUE(is_refused(with(tiles, 4, 0)));
    EXPECT_TRUE(is_refused(with(window, 12, 30000))) << "more tiles than the file has places of";
    EXPECT_TRUE(is_refused(with(window, 12, 0x7fffffff)));
    EXPECT_TRUE(is_refused(with(window, 4, 0x7fffffff))) << "nothing in it";
}

TEST(PictureKinds, DamagedExrIsRefusedOrDecoded) {
    for (const std::uint32_t tile : {0u, 8u}) {
        const Bytes whole = make_exr(width, height,
                                     {{.channels = {{"R", ExrKind::half_float}, {"G", ExrKind::half_float}, {"B", ExrKind::half_float}},
                                       .tile_width = tile,
                                       .tile_height = tile,
                                       .values = some_values(3)}});
        for (std::size_t size = 4; size < whole.size(); ++size)
            EXPECT_TRUE(is_refused({whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)})) << size << " of " << whole.size();
        for (std::size_t at = 4; at < whole.size(); ++at)
            for (const unsigned flip : {0x01u, 0x80u}) {
                Bytes flipped = whole;
                flipped[at] = static_cast<std::uint8_t>(flipped[at] ^ flip);
                (void)is_refused(flipped, {1024, 1 << 20});
            }
    }
}

TEST(PictureKinds, SizesAreLimited) {
    const Bytes pictures[]{make_png(png_sample(PngColour::rgb, 8, 3)),
                           make_jpeg(width, height, JpegColour::grey, false, smooth(width, height, 1)),
                           make_exr(width, height, {{.channels = {{"Y", ExrKind::half_float}}, .values = some_values(1)}})};
    for (const Bytes& picture : pictures) {
        EXPECT_FALSE(is_refused(picture, {width, pixel_count}));
        EXPECT_TRUE(is_refused(picture, {width - 1, pixel_count}));
        EXPECT_TRUE(is_refused(picture, {width, pixel_count - 1}));
    }
}

// Last: what comes after it has the module loaded.
TEST(PictureKinds, OnlyCmykOfTheseNeedsTheModule) {
    EXPECT_FALSE(image_library_is_loaded());
    const ImagePixels image = decode_image(make_jpeg(16, 16, JpegColour::cmyk, false, std::vector<std::uint8_t>(16 * 16 * 4, 255)), "cmyk");
    EXPECT_TRUE(image_library_is_loaded());
    ASSERT_EQ(image.pixels.size(), 256u);
}

}  // namespace
}  // namespace luxel
