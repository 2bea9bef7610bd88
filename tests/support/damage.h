/// What every decoder must do with bytes that are not its own: refuse them as a damaged store, never anything else.
#pragma once
#include <gtest/gtest.h>

#include <fstream>
#include <functional>

#include "formats/base/file.h"
#include "tests/support/block_contents.h"

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

/// Loads the file at `path`; true if it was refused as a damaged store, by an error that names the file and a way out.
inline bool file_refused(const std::filesystem::path& path, const std::function<void()>& load) {
    try {
        load();
    } catch (const Error& error) {
        EXPECT_EQ(error.code, ErrorCode::damaged_store) << error.what();
        EXPECT_NE(error.where.find(path.string()), std::string::npos) << error.what();
        EXPECT_FALSE(error.hint.empty()) << error.what();
        return true;
    }
    return false;
}

/// What must be true of every kind of file, tried on the valid one at `path`, which is left as it was. `load` reads all
/// of it. Refused are: every shorter length, a longer one, every flipped bit, and with right checksums another magic,
/// container version, kind, newer version or reserved field.
inline void expect_guarded(const std::filesystem::path& path, const std::function<void()>& load) {
    const Bytes whole = read_file(path);
    ASSERT_FALSE(file_refused(path, load));
    // In place and not published: syncing thousands of files takes minutes.
    for (std::size_t size = whole.size(); size-- > 0;) {
        std::filesystem::resize_file(path, size);
        ASSERT_TRUE(file_refused(path, load)) << "cut to " << size << " of " << whole.size() << " bytes";
    }
    Bytes bytes = whole;
    bytes.push_back(0);
    publish_file(path, bytes);
    EXPECT_TRUE(file_refused(path, load)) << "one byte more";
    publish_file(path, whole);
    std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
    const auto put = [&](std::size_t at, int byte) {
        file.seekp(static_cast<std::streamoff>(at)).put(static_cast<char>(byte)).flush();
    };
    for (std::size_t bit = 0; bit < 8 * whole.size(); ++bit) {
        put(bit / 8, whole[bit / 8] ^ (1 << bit % 8));
        ASSERT_TRUE(file_refused(path, load)) << "bit " << bit % 8 << " of byte " << bit / 8;
        put(bit / 8, whole[bit / 8]);
    }
    file.close();
    ASSERT_EQ(read_file(path), whole);
    const std::pair<std::size_t, const char*> fields[]{{0, "magic"},     {8, "container version"},
                                                       {12, "kind"},     {16, "version"},
                                                       {20, "reserved"}, {whole.size() - 1, "footer magic"}};
    for (const auto& [at, field] : fields) {
        bytes = whole;
        ++bytes[at];
        reseal(bytes);
        publish_file(path, bytes);
        EXPECT_TRUE(file_refused(path, load)) << field;
    }
    publish_file(path, whole);
    EXPECT_FALSE(file_refused(path, load));
}

/// With right checksums and any one block under another tag the file is refused.
inline void expect_tags_guarded(const std::filesystem::path& path, const std::function<void()>& load) {
    const Bytes whole = read_file(path);
    const BlockContents contents = contents_of(path);
    write_contents(path, contents);
    EXPECT_FALSE(file_refused(path, load)) << "the codec of a block is free";
    for (std::size_t k = 0; k < contents.parts.size(); ++k) {
        BlockContents changed = contents;
        ++changed.parts[k].tag;
        write_contents(path, changed);
        EXPECT_TRUE(file_refused(path, load)) << "block " << k;
    }
    publish_file(path, whole);
}

}  // namespace luxel::test
