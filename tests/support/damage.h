/// What every decoder must do with bytes that are not its own: refuse them as a damaged store, never anything else.
#pragma once
#include <gtest/gtest.h>

#include <functional>

#include "formats/base/bytes.h"

namespace luxel::test {

/// Decodes a copy that ends where the bytes end, so that a sanitizer sees a read beyond. True if it was refused.
inline bool refused(ByteView bytes, const std::function<void(ByteView)>& decode) {
    const Bytes copy(bytes.begin(), bytes.end());
    try {
        decode(copy);
    } catch (const Error& error) {
        EXPECT_EQ(error.code, ErrorCode::damaged_store) << error.what();
        EXPECT_FALSE(error.where.empty());
        return true;
    }
    return false;
}

/// Every shorter version and one longer one are refused.
inline void expect_exact_length(const Bytes& bytes, const std::function<void(ByteView)>& decode) {
    EXPECT_FALSE(refused(bytes, decode));
    for (std::size_t size = 0; size < bytes.size(); ++size)
        EXPECT_TRUE(refused(ByteView(bytes).first(size), decode)) << "cut to " << size << " bytes";
    Bytes longer = bytes;
    longer.push_back(0);
    EXPECT_TRUE(refused(longer, decode)) << "one byte more";
}

}  // namespace luxel::test
