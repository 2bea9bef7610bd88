#include "formats/base/block_file.h"

#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"

namespace luxel {
namespace {

const Key key{0x1111, 0x2222};

Bytes pattern(std::size_t size) {
    Bytes bytes(size);
    for (std::size_t k = 0; k < size; ++k) bytes[k] = static_cast<std::uint8_t>(k / 7);
    return bytes;
}

void write_sample(const std::filesystem::path& path) {
    BlockFileWriter file(path, FileKind::strip, 3, key);
    file.append(7, pattern(1000), 3);
    file.append(8, pattern(10), 0);
    file.append(9, {}, 1);
    file.publish();
}

ErrorCode code_of(const std::function<void()>& body) {
    try {
        body();
    } catch (const Error& error) {
        return error.code;
    }
    return ErrorCode{0};
}

/// Opens and reads everything.
void read_all(const std::filesystem::path& path) {
    const BlockFileReader file(path, FileKind::strip, 3, &key);
    for (std::size_t k = 0; k < file.blocks().size(); ++k) (void)file.read(k);
}

TEST(BlockFile, ReturnsWhatWasWritten) {
    const test::TemporaryFolder folder;
    write_sample(folder / "a");
    const BlockFileReader file(folder / "a", FileKind::strip, 3, &key);
    ASSERT_EQ(file.blocks().size(), 3u);
    EXPECT_EQ(file.blocks()[0].tag, 7u);
    EXPECT_EQ(file.blocks()[0].codec, Codec::zstd);
    EXPECT_EQ(file.blocks()[1].codec, Codec::raw);
    EXPECT_EQ(file.read(0), pattern(1000));
    EXPECT_EQ(file.read(1), pattern(10));
    EXPECT_TRUE(file.read(2).empty());
    EXPECT_TRUE(block_file_is_whole(folder / "a", FileKind::strip, 3, key));
}

TEST(BlockFile, IsAbsentUntilPublished) {
    const test::TemporaryFolder folder;
    {
        BlockFileWriter file(folder / "a", FileKind::strip, 3, key);
        file.append(1, pattern(10), 0);
        EXPECT_FALSE(std::filesystem::exists(folder / "a"));
    }
    EXPECT_TRUE(std::filesystem::is_empty(folder.path())) << "the temporary is left behind";
}

TEST(BlockFile, RejectsEveryTruncation) {
    const test::TemporaryFolder folder;
    write_sample(folder / "a");
    const Bytes whole = read_file(folder / "a");
    for (std::size_t size = 0; size < whole.size(); ++size) {
        publish_file(folder / "cut", ByteView(whole).first(size));
        EXPECT_EQ(code_of([&] { read_all(folder / "cut"); }), ErrorCode::damaged_store) << "length " << size;
    }
}

TEST(BlockFile, RejectsEveryFlippedByte) {
    const test::TemporaryFolder folder;
    write_sample(folder / "a");
    const Bytes whole = read_file(folder / "a");
    for (std::size_t at = 0; at < whole.size(); ++at) {
        Bytes altered = whole;
        altered[at] ^= 0x40;
        publish_file(folder / "flipped", altered);
        EXPECT_EQ(code_of([&] { read_all(folder / "flipped"); }), ErrorCode::damaged_store) << "byte " << at;
    }
}

TEST(BlockFile, RejectsOtherKindVersionKeyAndExtraBytes) {
    const test::TemporaryFolder folder;
    write_sample(folder / "a");
    EXPECT_EQ(code_of([&] { BlockFileReader(folder / "a", FileKind::atlas, 3); }), ErrorCode::damaged_store);
    EXPECT_EQ(code_of([&] { BlockFileReader(folder / "a", FileKind::strip, 4); }), ErrorCode::damaged_store);
    const Key other{1, 2};
    EXPECT_EQ(code_of([&] { BlockFileReader(folder / "a", FileKind::strip, 3, &other); }), ErrorCode::damaged_store);
    Bytes longer = read_file(folder / "a");
    longer.push_back(0);
    publish_file(folder / "longer", longer);
    EXPECT_EQ(code_of([&] { read_all(folder / "longer"); }), ErrorCode::damaged_store);
    EXPECT_EQ(code_of([&] { read_all(folder / "missing"); }), ErrorCode::damaged_store);
}

TEST(BlockFile, SameInputGivesSameBytes) {
    const test::TemporaryFolder folder;
    write_sample(folder / "a");
    write_sample(folder / "b");
    EXPECT_EQ(read_file(folder / "a"), read_file(folder / "b"));
}

// The smallest file, byte for byte as block_file.md describes it: the format may not drift.
TEST(BlockFile, LayoutIsPinned) {
    const test::TemporaryFolder folder;
    BlockFileWriter file(folder / "a", FileKind::atlas, 1, {1, 2});
    file.publish();
    const Bytes bytes = read_file(folder / "a");
    ASSERT_EQ(bytes.size(), 48u + 40u);
    const Bytes expected_header{0x0a, 0x58, 0x55, 0x4c, 0x42, 0x4c, 0x4b, 0x31, 1, 0, 0, 0, 1, 0, 0, 0,
                                1,    0,    0,    0,    0,    0,    0,    0,    1, 0, 0, 0, 0, 0, 0, 0,
                                2,    0,    0,    0,    0,    0,    0,    0};
    EXPECT_EQ(Bytes(bytes.begin(), bytes.begin() + 40), expected_header);
    const Bytes expected_magic{0x4b, 0x58, 0x55, 0x4c, 0x45, 0x4e, 0x44, 0x0a};
    EXPECT_EQ(Bytes(bytes.end() - 8, bytes.end()), expected_magic);
}

}  // namespace
}  // namespace luxel
