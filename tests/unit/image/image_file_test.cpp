// Decoding of pictures made by other programs, damage, and what is written: values, metadata, the same bytes twice.
#include "formats/image/image_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <functional>
#include <string_view>

namespace luxel {
namespace {

// 2 x 2 pixels: (255,0,0,255), (0,128,0,128) / (0,0,64,0), (10,20,30,200). Written by Pillow.
const Bytes png_rgba = {137, 80,  78,  71,  13,  10,  26,  10,  0,   0,   0,   13,  73,  72,  68,  82,  0,
                        0,   0,   2,   0,   0,   0,   2,   8,   6,   0,   0,   0,   114, 182, 13,  36,  0,
                        0,   0,   26,  73,  68,  65,  84,  120, 156, 99,  248, 207, 192, 240, 159, 161, 129,
                        161, 129, 129, 129, 193, 129, 129, 75,  68,  238, 4,   0,   44,  219, 4,   67,  219,
                        106, 166, 242, 0,   0,   0,   0,   73,  69,  78,  68,  174, 66,  96,  130};
const Bytes webp_rgba = {82,  73,  70, 70,  64, 0,   0,   0,   87,  69,  66, 80,  86,  80, 56, 76,  52,  0,
                         0,   0,   47, 1,   64, 0,   16,  31,  32,  16,  72, 113, 16,  99, 46, 180, 33,  166,
                         250, 255, 86, 149, 66, 182, 17,  160, 161, 157, 63, 196, 75,  34, 32, 33,  242, 255,
                         144, 9,   94, 9,   51, 68,  186, 187, 80,  18,  32, 0,   138, 50, 18, 209, 255, 24};
// 1 x 1: grey 51 with alpha 102, and colour (51,102,204) through a palette.
const Bytes png_grey_alpha = {137, 80, 78,  71,  13, 10, 26, 10,  0,   0,  0,  13, 73,  72,  68, 82,  0,
                              0,   0,  1,   0,   0,  0,  1,  8,   4,   0,  0,  0,  181, 28,  12, 2,   0,
                              0,   0,  11,  73,  68, 65, 84, 120, 156, 99, 48, 78, 3,   0,   0,  207, 0,
                              154, 11, 245, 220, 34, 0,  0,  0,   0,   73, 69, 78, 68,  174, 66, 96,  130};
const Bytes png_palette = {137, 80,  78,  71,  13,  10, 26, 10, 0,   0,   0,  13,  73,  72,  68, 82,  0,
                           0,   0,   1,   0,   0,   0,  1,  1,  3,   0,   0,  0,   37,  219, 86, 202, 0,
                           0,   0,   6,   80,  76,  84, 69, 0,  0,   0,   51, 102, 204, 34,  63, 160, 188,
                           0,   0,   0,   10,  73,  68, 65, 84, 120, 156, 99, 104, 0,   0,   0,  130, 0,
                           129, 119, 205, 114, 182, 0,  0,  0,  0,   73,  69, 78,  68,  174, 66, 96,  130};

// 8 x 8 grey pixels of 100.
const Bytes jpeg_grey = {
    255, 216, 255, 224, 0,   16,  74,  70,  73,  70,  0,   1,   1,   0,   0,   1,   0,   1,   0,   0,   255, 219, 0,
    67,  0,   8,   6,   6,   7,   6,   5,   8,   7,   7,   7,   9,   9,   8,   10,  12,  20,  13,  12,  11,  11,  12,
    25,  18,  19,  15,  20,  29,  26,  31,  30,  29,  26,  28,  28,  32,  36,  46,  39,  32,  34,  44,  35,  28,  28,
    40,  55,  41,  44,  48,  49,  52,  52,  52,  31,  39,  57,  61,  56,  50,  60,  46,  51,  52,  50,  255, 192, 0,
    11,  8,   0,   8,   0,   8,   1,   1,   17,  0,   255, 196, 0,   31,  0,   0,   1,   5,   1,   1,   1,   1,   1,
    1,   0,   0,   0,   0,   0,   0,   0,   0,   1,   2,   3,   4,   5,   6,   7,   8,   9,   10,  11,  255, 196, 0,
    181, 16,  0,   2,   1,   3,   3,   2,   4,   3,   5,   5,   4,   4,   0,   0,   1,   125, 1,   2,   3,   0,   4,
    17,  5,   18,  33,  49,  65,  6,   19,  81,  97,  7,   34,  113, 20,  50,  129, 145, 161, 8,   35,  66,  177, 193,
    21,  82,  209, 240, 36,  51,  98,  114, 130, 9,   10,  22,  23,  24,  25,  26,  37,  38,  39,  40,  41,  42,  52,
    53,  54,  55,  56,  57,  58,  67,  68,  69,  70,  71,  72,  73,  74,  83,  84,  85,  86,  87,  88,  89,  90,  99,
    100, 101, 102, 103, 104, 105, 106, 115, 116, 117, 118, 119, 120, 121, 122, 131, 132, 133, 134, 135, 136, 137, 138,
    146, 147, 148, 149, 150, 151, 152, 153, 154, 162, 163, 164, 165, 166, 167, 168, 169, 170, 178, 179, 180, 181, 182,
    183, 184, 185, 186, 194, 195, 196, 197, 198, 199, 200, 201, 202, 210, 211, 212, 213, 214, 215, 216, 217, 218, 225,
    226, 227, 228, 229, 230, 231, 232, 233, 234, 241, 242, 243, 244, 245, 246, 247, 248, 249, 250, 255, 218, 0,   8,
    1,   1,   0,   0,   63,  0,   195, 175, 255, 217};

void expect_pixel(const std::array<float, 4>& pixel, std::array<int, 4> bytes, float error = 1e-6f) {
    for (std::size_t c = 0; c < 4; ++c) EXPECT_NEAR(pixel[c], static_cast<float>(bytes[c]) / 255.0f, error);
}

ErrorCode code_of(const std::function<void()>& action) {
    try {
        action();
    } catch (const Error& error) {
        return error.code;
    }
    return ErrorCode{};
}

TEST(ImageFile, MissingModuleIsSaidAndNotLoadedBefore) {
    EXPECT_FALSE(image_library_is_loaded());
    ::setenv("LUXEL_PLUGIN_DIR", "/nowhere", 1);
    EXPECT_EQ(code_of([] { (void)decode_image(webp_rgba, "picture"); }), ErrorCode::not_in_build);
    ::unsetenv("LUXEL_PLUGIN_DIR");
    EXPECT_EQ(code_of([] { (void)decode_image(Bytes{1, 2, 3, 4}, "picture"); }), ErrorCode::bad_input);
    EXPECT_FALSE(image_library_is_loaded()) << "the first bytes decide without the library";
}

TEST(ImageFile, CommonKindsDoNotLoadTheModule) {
    (void)decode_image(png_rgba, "png");
    (void)decode_image(jpeg_grey, "jpeg");
    const std::vector<float> values(12, 0.5f);
    (void)decode_image(encode_exr({2, 2, {"R", "G", "B"}, values}, ExrSample::half_float, {}), "exr");
    (void)encode_png(1, 1, std::vector<std::uint8_t>{1, 2, 3}, {});
    EXPECT_FALSE(image_library_is_loaded());
}

TEST(ImageFile, DecodesAsStored) {
    for (const Bytes* file : {&png_rgba, &webp_rgba}) {
        const bool is_webp = file == &webp_rgba;
        const float error = is_webp ? 0.005f : 1e-6f;  // alpha was multiplied in, in 8 bits, and divided out again
        const ImagePixels image = decode_image(*file, "picture");
        ASSERT_EQ(image.width, 2u);
        ASSERT_EQ(image.height, 2u);
        EXPECT_FALSE(image.is_float);
        expect_pixel(image.pixels[0], {255, 0, 0, 255}, error);
        expect_pixel(image.pixels[1], {0, 128, 0, 128}, error);
        expect_pixel(image.pixels[2], {0, 0, is_webp ? 0 : 64, 0}, error);
        expect_pixel(image.pixels[3], {10, 20, 30, 200}, error);
    }
    expect_pixel(decode_image(png_grey_alpha, "grey").pixels.at(0), {51, 51, 51, 102});
    expect_pixel(decode_image(png_palette, "palette").pixels.at(0), {51, 102, 204, 255});
    expect_pixel(decode_image(jpeg_grey, "jpeg").pixels.at(63), {100, 100, 100, 255}, 0.005f);
    EXPECT_TRUE(image_library_is_loaded()) << "WebP needs it";
}

TEST(ImageFile, DecodesRadiance) {
    // 2 x 1, flat scanline: (1, 0.5, 0.25) and (2, 2, 2) as shared exponents.
    std::string text = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n";
    Bytes file(text.begin(), text.end());
    const Bytes pixels = {128, 64, 32, 129, 128, 128, 128, 130};
    file.insert(file.end(), pixels.begin(), pixels.end());
    const ImagePixels image = decode_image(file, "sky");
    ASSERT_EQ(image.pixels.size(), 2u);
    EXPECT_TRUE(image.is_float);
    EXPECT_NEAR(image.pixels[0][0], 1.0, 0.01);
    EXPECT_NEAR(image.pixels[0][1], 0.5, 0.01);
    EXPECT_NEAR(image.pixels[1][2], 2.0, 0.02);
}

TEST(ImageFile, EveryTruncationAndFlipIsRefusedOrDecoded) {
    for (const Bytes* file : {&png_rgba, &webp_rgba, &jpeg_grey}) {
        const std::size_t pixels = file == &jpeg_grey ? 64 : 4;
        for (std::size_t size = 0; size < file->size(); ++size) {
            const Bytes cut(file->begin(), file->begin() + static_cast<std::ptrdiff_t>(size));
            try {
                const ImagePixels image = decode_image(cut, "cut");
                EXPECT_EQ(image.pixels.size(), pixels);
            } catch (const Error& error) {
                EXPECT_EQ(error.code, ErrorCode::bad_input);
            }
        }
        for (std::size_t at = 8; at < file->size(); ++at) {
            Bytes flipped = *file;
            flipped[at] ^= 0x40;
            try {
                (void)decode_image(flipped, "flipped", {1024, 1 << 20});
            } catch (const Error& error) {
                EXPECT_EQ(error.code, ErrorCode::bad_input);
            }
        }
    }
}

TEST(ImageFile, SizeIsLimitedBeforeAllocation) {
    EXPECT_EQ(code_of([] { (void)decode_image(png_rgba, "picture", {1, 100}); }), ErrorCode::bad_input);
    EXPECT_EQ(code_of([] { (void)decode_image(png_rgba, "picture", {100, 3}); }), ErrorCode::bad_input);
    // 4 billion pixels in a header of a few bytes.
    std::string text = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 65536 +X 65536\n";
    EXPECT_EQ(code_of([&] { (void)decode_image(Bytes(text.begin(), text.end()), "bomb"); }), ErrorCode::bad_input);
}

ImageMetadata metadata() {
    ImageMetadata meta;
    meta.quantity = "irradiance";
    meta.unit = "lux";
    meta.encoding = "linear";
    meta.intensity = 12.5;
    meta.software = "luxel test";
    meta.more = {{"page", "3"}};
    return meta;
}

bool contains(const Bytes& bytes, std::string_view text) {
    return std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()).find(text) !=
           std::string_view::npos;
}

std::vector<float> ramp(std::size_t count) {
    std::vector<float> values(count);
    for (std::size_t k = 0; k < count; ++k) values[k] = static_cast<float>(k * k) * 0.37f;
    return values;
}

TEST(ImageFile, ExrKeepsFloatsExactlyAndBytesRepeat) {
    const std::vector<float> values = ramp(70 * 33 * 3);
    const ImageView view{70, 33, {"R", "G", "B"}, values};
    const Bytes first = encode_exr(view, ExrSample::float_32, metadata());
    EXPECT_EQ(first, encode_exr(view, ExrSample::float_32, metadata()));
    for (const char* text :
         {"quantity", "irradiance", "unit", "lux", "encoding", "intensity", "luxel test", "page", "1970:01:01"})
        EXPECT_TRUE(contains(first, text)) << text;
    const ImagePixels back = decode_image(first, "exr");
    ASSERT_EQ(back.pixels.size(), 70u * 33u);
    EXPECT_TRUE(back.is_float);
    for (std::size_t k = 0; k < back.pixels.size(); ++k)
        for (std::size_t c = 0; c < 3; ++c) ASSERT_EQ(back.pixels[k][c], values[3 * k + c]);
}

TEST(ImageFile, ExrHalfAndMoreChannels) {
    const std::vector<float> values = ramp(20 * 4 * 5);
    const ImageView view{20, 4, {"R", "G", "B", "coverage", "error"}, values};
    const ImagePixels back = decode_image(encode_exr(view, ExrSample::half_float, metadata()), "exr");
    for (std::size_t k = 0; k < back.pixels.size(); ++k)
        for (std::size_t c = 0; c < 3; ++c)
            ASSERT_NEAR(back.pixels[k][c], values[5 * k + c], values[5 * k + c] * 0x1p-11f + 1e-7f);
}

TEST(ImageFile, SampleTypeFollowsTheRange) {
    const auto sample = [](std::vector<float> values) { return exr_sample_for(values); };
    EXPECT_EQ(sample({0, 0}), ExrSample::half_float);
    EXPECT_EQ(sample({0, 1, 65504}), ExrSample::half_float);
    EXPECT_EQ(sample({0, 65505}), ExrSample::float_32);
    EXPECT_EQ(sample({1e-5f, 2e-5f}), ExrSample::float_32);
    EXPECT_EQ(sample({1e30f}), ExrSample::float_32);
    EXPECT_EQ(sample({1000, 1e-5f}), ExrSample::half_float) << "nothing beside the largest";
}

TEST(ImageFile, PngRoundTripWithMetadataAndRepeatableBytes) {
    std::vector<std::uint8_t> rgb(61 * 17 * 3);
    for (std::size_t k = 0; k < rgb.size(); ++k) rgb[k] = static_cast<std::uint8_t>(k * 7);
    const Bytes first = encode_png(61, 17, rgb, metadata());
    EXPECT_EQ(first, encode_png(61, 17, rgb, metadata()));
    for (const char* text : {"quantity", "irradiance", "unit", "lux", "12.5", "luxel test"})
        EXPECT_TRUE(contains(first, text)) << text;
    for (const char* chunk : {"gAMA", "sRGB", "cHRM", "tIME"}) EXPECT_FALSE(contains(first, chunk)) << chunk;
    const ImagePixels back = decode_image(first, "png");
    for (std::size_t k = 0; k < back.pixels.size(); ++k)
        expect_pixel(back.pixels[k], {rgb[3 * k], rgb[3 * k + 1], rgb[3 * k + 2], 255});
}

}  // namespace
}  // namespace luxel
