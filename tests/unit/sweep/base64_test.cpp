// Base64 against the vectors of RFC 4648, section 10.
#include "baker/sweep/base64.h"

#include <gtest/gtest.h>

namespace luxel {
namespace {

TEST(Base64, VectorsOfTheStandard) {
    for (const auto& [bytes, text] : {std::pair{"", ""}, {"f", "Zg=="}, {"fo", "Zm8="}, {"foo", "Zm9v"}, {"foob", "Zm9vYg=="}, {"fooba", "Zm9vYmE="}, {"foobar", "Zm9vYmFy"}}) {
        EXPECT_EQ(base64(bytes), text);
        EXPECT_EQ(from_base64(text), bytes);
    }
}

TEST(Base64, AllBytesComeBack) {
    std::string bytes;
    for (int k = 0; k < 256; ++k) bytes += static_cast<char>(k);
    for (std::size_t size = 250; size <= 256; ++size) EXPECT_EQ(from_base64(base64(bytes.substr(0, size))), bytes.substr(0, size));
}

TEST(Base64, OtherTextIsRefused) {
    for (const char* text : {"Z", "Zg", "Zg=", "Zh==", "Zg==Zg==", "Zm9*", "Z===", "====", "Zm8 ", "\xff\xff\xff\xff"}) EXPECT_FALSE(from_base64(text)) << text;
}

}  // namespace
}  // namespace luxel
