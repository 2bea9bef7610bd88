#include "formats/base/bytes.h"

#include <gtest/gtest.h>

#include "formats/base/compress.h"
#include "formats/base/hash.h"

namespace luxel {
namespace {

TEST(Bytes, VarintsReturn) {
    ByteWriter out;
    const std::uint64_t values[] = {0, 1, 127, 128, 300, 1u << 31, ~std::uint64_t{0}};
    for (const std::uint64_t value : values) out.put_varint(value);
    ByteCursor in(out.bytes(), "test");
    for (const std::uint64_t value : values) EXPECT_EQ(in.get_varint("value"), value);
    EXPECT_NO_THROW(in.expect_end("end"));
}

TEST(Bytes, EndOfInputIsAnErrorThatNamesFieldAndOffset) {
    const Bytes bytes{1, 2, 3};
    ByteCursor in(bytes, "some.file");
    (void)in.get<std::uint16_t>("first");
    try {
        (void)in.get<std::uint32_t>("second");
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.where, "some.file");
        EXPECT_NE(error.what_text.find("second at byte 2"), std::string::npos) << error.what_text;
    }
    EXPECT_THROW((void)in.get_array<std::uint64_t>(~std::uint64_t{0}, "huge"), Error);
    const Bytes endless(11, 0xff);
    ByteCursor varint(endless, "x");
    EXPECT_THROW((void)varint.get_varint("v"), Error);
    Bytes large(10, 0xff);
    large.back() = 1;
    EXPECT_EQ(ByteCursor(large, "x").get_varint("v"), ~std::uint64_t{0});
    large.back() = 2;
    EXPECT_THROW((void)ByteCursor(large, "x").get_varint("v"), Error) << "bits that would be lost";
}

TEST(Bytes, DecompressRefusesOtherSizesAndDamage) {
    const Bytes raw(500, 7);
    Bytes frame = compress(raw, 3);
    EXPECT_EQ(decompress(frame, 500, "x"), raw);
    EXPECT_THROW((void)decompress(frame, 499, "x"), Error);
    frame.pop_back();
    EXPECT_THROW((void)decompress(frame, 500, "x"), Error);
    EXPECT_THROW((void)decompress({}, 0, "x"), Error);
}

TEST(Bytes, AFrameIsBelievedNoMoreThanItCanHold) {
    const Bytes zeros(std::size_t{1} << 24);
    const Bytes frame = compress(zeros, 3);
    EXPECT_LT(frame.size() * 30000, zeros.size()) << "this one comes near to the limit";
    EXPECT_EQ(decompress(frame, zeros.size(), "x"), zeros);
    Bytes claims{0x28, 0xb5, 0x2f, 0xfd, 0xe0};  // a frame whose header promises 2^40 bytes
    for (const int byte : {0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0}) claims.push_back(static_cast<std::uint8_t>(byte));
    try {
        (void)decompress(claims, std::uint64_t{1} << 40, "x");
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.code, ErrorCode::damaged_store);
        EXPECT_NE(error.what_text.find("cannot hold"), std::string::npos) << error.what_text;
    }
}

TEST(Hash, KeysSeparateParts) {
    const Key a = KeyBuilder("t").text("ab").text("c").finish();
    const Key b = KeyBuilder("t").text("a").text("bc").finish();
    EXPECT_NE(a, b);
    EXPECT_EQ(a, KeyBuilder("t").text("ab").text("c").finish());
    EXPECT_EQ(a.text().size(), 32u);
}

}  // namespace
}  // namespace luxel
