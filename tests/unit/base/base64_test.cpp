// Base64 against the vectors of RFC 4648, section 10. What else is read: tests/unit/gltf/gltf_document_test.cpp.
#include "formats/base/base64.h"

#include <gtest/gtest.h>

namespace luxel {
namespace {

TEST(Base64, VectorsOfTheStandard) {
    for (const auto& [text, code] : {std::pair{"", ""}, {"f", "Zg=="}, {"fo", "Zm8="}, {"foo", "Zm9v"}, {"foob", "Zm9vYg=="}, {"fooba", "Zm9vYmE="}, {"foobar", "Zm9vYmFy"}}) {
        const Bytes bytes(text, text + std::string_view(text).size());
        EXPECT_EQ(encode_base64(bytes), code);
        EXPECT_EQ(decode_base64(code), bytes);
    }
}

TEST(Base64, AllBytesComeBack) {
    Bytes bytes;
    for (int k = 0; k < 256; ++k) bytes.push_back(static_cast<std::uint8_t>(k));
    for (; bytes.size() > 250; bytes.pop_back()) EXPECT_EQ(decode_base64(encode_base64(bytes)), bytes);
}

TEST(Base64, OtherTextIsRefused) {
    for (const char* text : {"Z", "Zm9vZ", "Zg==Zg==", "Zm9*", "Zm8 ", "\xff\xff\xff\xff"}) EXPECT_FALSE(decode_base64(text)) << text;
}

}  // namespace
}  // namespace luxel
