// Radiance HDR, KTX 2.0 and the wider kinds of PNG: what is written is read back, by independent readers or field by field.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "formats/base/compress.h"
#include "formats/image/image_file.h"

namespace luxel {
namespace {

ImageMetadata meaning() {
    ImageMetadata metadata{"irradiance", "lux", "some", 2.5, "luxel 9.9.9", {}};
    metadata.more.emplace_back("range", "8");
    return metadata;
}

std::string text_of(const Bytes& bytes) { return {bytes.begin(), bytes.end()}; }

/// Runs of all lengths, noise, and what is in between.
std::vector<std::uint8_t> rgbe_pixels(std::uint32_t width, std::uint32_t height) {
    std::vector<std::uint8_t> pixels;
    std::uint32_t noise = 1;
    for (std::uint32_t y = 0; y < height; ++y)
        for (std::uint32_t x = 0; x < width; ++x) {
            noise = noise * 1664525u + 1013904223u;
            const bool is_even = x / (y + 1) % 2 == 0;
            pixels.insert(pixels.end(), {static_cast<std::uint8_t>(is_even ? 200 : noise >> 24), static_cast<std::uint8_t>(x / 3),
                                         static_cast<std::uint8_t>(noise >> 16), static_cast<std::uint8_t>(120 + y % 16)});
        }
    return pixels;
}

TEST(WrittenKinds, HdrIsReadBackByOpenImageIO) {
    for (const auto& [width, height] : {std::pair{1u, 1u}, {7u, 3u}, {8u, 2u}, {300u, 40u}, {1025u, 3u}}) {
        const auto pixels = rgbe_pixels(width, height);
        const Bytes file = encode_hdr(width, height, pixels, meaning());
        EXPECT_EQ(file, encode_hdr(width, height, pixels, meaning()));
        const ImagePixels image = decode_image(file, "hdr");
        ASSERT_EQ(image.width, width);
        ASSERT_EQ(image.height, height);
        EXPECT_TRUE(image.is_float);
        for (std::size_t k = 0; k < image.pixels.size(); ++k)
            for (std::size_t c = 0; c < 3; ++c)
                ASSERT_EQ(image.pixels[k][c], std::ldexp(static_cast<float>(pixels[4 * k + c]), pixels[4 * k + 3] - 136)) << width << " " << k;
    }
}

TEST(WrittenKinds, HdrSaysWhatItMeansOnLinesOfItsOwn) {
    ImageMetadata metadata = meaning();
    metadata.software = "two\nlines";
    const std::string text = text_of(encode_hdr(1, 1, std::vector<std::uint8_t>{1, 2, 3, 128}, metadata));
    EXPECT_TRUE(text.starts_with("#?RADIANCE\n"));
    for (const char* line : {"\n# quantity=irradiance\n", "\n# intensity=2.5\n", "\n# range=8\n", "\n# Software=two lines\n"})
        EXPECT_NE(text.find(line), std::string::npos) << line;
    EXPECT_TRUE(text.ends_with("\n\n-Y 1 +X 1\n\x01\x02\x03\x80"));
    EXPECT_THROW((void)encode_hdr(2, 1, std::vector<std::uint8_t>(4), metadata), Error);
}

TEST(WrittenKinds, PngKeepsSixteenBitsAndAlpha) {
    std::vector<std::uint16_t> wide;
    std::vector<std::uint8_t> four;
    for (std::uint32_t k = 0; k < 64 * 64 * 3; ++k) wide.push_back(static_cast<std::uint16_t>(k * 40503u));
    for (std::uint32_t k = 0; k < 64 * 64 * 4; ++k) four.push_back(static_cast<std::uint8_t>(k * 151u >> 3));
    const ImagePixels from_wide = decode_image(encode_png_16(64, 64, wide, meaning()), "16");
    const ImagePixels from_four = decode_image(encode_png_rgba(64, 64, four, meaning()), "rgba");
    for (std::size_t k = 0; k < 64 * 64; ++k)
        for (std::size_t c = 0; c < 4; ++c) {
            if (c < 3) {
                ASSERT_EQ(std::lround(from_wide.pixels[k][c] * 65535.0f), wide[3 * k + c]);
            }
            ASSERT_EQ(std::lround(from_four.pixels[k][c] * 255.0f), four[4 * k + c]);
        }
    EXPECT_THROW((void)encode_png_16(64, 64, std::span(wide).first(5), meaning()), Error);
    EXPECT_THROW((void)encode_png_rgba(64, 64, std::span(four).first(5), meaning()), Error);
}

std::map<std::string, std::string> key_values(ByteCursor& cursor, std::uint64_t end, std::vector<std::string>& order) {
    std::map<std::string, std::string> entries;
    while (cursor.at() < end) {
        const auto length = cursor.get<std::uint32_t>("length");
        const ByteView bytes = cursor.get_view(length, "entry");
        const std::string entry(bytes.begin(), bytes.end());
        const std::size_t middle = entry.find('\0');
        EXPECT_EQ(entry.back(), '\0');
        entries[entry.substr(0, middle)] = entry.substr(middle + 1, entry.size() - middle - 2);
        order.push_back(entry.substr(0, middle));
        while (cursor.at() % 4) EXPECT_EQ(cursor.get<std::uint8_t>("padding"), 0);
    }
    EXPECT_EQ(cursor.at(), end);
    return entries;
}

void expect_descriptor(ByteCursor& cursor) {
    for (const std::uint32_t word : {92u, 0u, 2u | 88u << 16, 1u | 1u << 8 | 1u << 16, 0u, 8u, 0u}) EXPECT_EQ(cursor.get<std::uint32_t>("dfd"), word);
    for (const std::uint32_t channel : {0u, 1u, 2u, 15u}) {
        const std::uint32_t offset = channel == 15 ? 48 : 16 * channel;
        EXPECT_EQ(cursor.get<std::uint32_t>("sample"), offset | 15u << 16 | (channel | 0xc0u) << 24);
        EXPECT_EQ(cursor.get<std::uint32_t>("position"), 0u);
        EXPECT_EQ(cursor.get<float>("lower"), -1.0f);
        EXPECT_EQ(cursor.get<float>("upper"), 1.0f);
    }
}

TEST(WrittenKinds, Ktx2IsWhatItsDocumentSays) {
    constexpr std::uint32_t width = 20, height = 12;
    std::vector<std::uint16_t> halves;
    for (std::uint32_t k = 0; k < width * height * 4; ++k) halves.push_back(static_cast<std::uint16_t>(k * 77));
    const Bytes file = encode_ktx2(width, height, halves, meaning());
    EXPECT_EQ(file, encode_ktx2(width, height, halves, meaning()));
    ByteCursor cursor(file, "ktx2");
    for (const int byte : {0xab, 0x4b, 0x54, 0x58, 0x20, 0x32, 0x30, 0xbb, 0x0d, 0x0a, 0x1a, 0x0a}) EXPECT_EQ(cursor.get<std::uint8_t>("id"), byte);
    for (const std::uint32_t number : {97u, 2u, width, height, 0u, 0u, 1u, 1u, 2u, 104u, 92u, 196u})
        EXPECT_EQ(cursor.get<std::uint32_t>("header"), number);
    const auto values_bytes = cursor.get<std::uint32_t>("kvd");
    for (int k = 0; k < 2; ++k) EXPECT_EQ(cursor.get<std::uint64_t>("sgd"), 0u);
    const auto level_at = cursor.get<std::uint64_t>("level"), level_bytes = cursor.get<std::uint64_t>("level");
    EXPECT_EQ(cursor.get<std::uint64_t>("raw"), halves.size() * 2);
    EXPECT_EQ(level_at, 196u + values_bytes);
    ASSERT_EQ(level_at + level_bytes, file.size());
    ASSERT_EQ(cursor.at(), 104u);
    expect_descriptor(cursor);

    std::vector<std::string> order;
    const auto entries = key_values(cursor, level_at, order);
    EXPECT_EQ(entries, (std::map<std::string, std::string>{{"KTXorientation", "rd"}, {"KTXwriter", "luxel 9.9.9"}, {"encoding", "some"},
                                                           {"intensity", "2.5"}, {"quantity", "irradiance"}, {"range", "8"}, {"unit", "lux"}}));
    EXPECT_TRUE(std::ranges::is_sorted(order));
    const Bytes raw = decompress(ByteView(file).subspan(level_at), halves.size() * 2, "level");
    const ByteView expected = bytes_of(halves);
    EXPECT_EQ(raw, Bytes(expected.begin(), expected.end()));
    EXPECT_THROW((void)encode_ktx2(width, height, std::span(halves).first(4), meaning()), Error);
}

}  // namespace
}  // namespace luxel
