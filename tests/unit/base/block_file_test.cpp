#include "formats/base/block_file.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/damage.h"
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

TEST(BlockFile, RejectsEveryTruncationAndFlippedBit) {
    const test::TemporaryFolder folder;
    write_sample(folder / "a");
    test::expect_guarded(folder / "a", [&] { read_all(folder / "a"); });
}

/// Changes a 64-bit field of the index or footer, counted from the end of the file, and makes all checksums right
/// again.
void set_field(const std::filesystem::path& path, std::size_t from_end, std::uint64_t value) {
    Bytes bytes = read_file(path);
    std::memcpy(bytes.data() + bytes.size() - from_end, &value, 8);
    test::reseal(bytes);
    publish_file(path, bytes);
}

// Fields of the index of write_sample, which has three blocks: entry k begins 40 + (3 - k) * 40 bytes before the end.
TEST(BlockFile, RejectsAnIndexThatDoesNotAddUp) {
    const test::TemporaryFolder folder;
    const auto path = folder / "a";
    const auto refuses = [&](std::size_t from_end, std::uint64_t value) {
        write_sample(path);
        set_field(path, from_end, value);
        return test::file_refused(path, [&] { read_all(path); });
    };
    write_sample(path);
    const std::vector<BlockEntry> blocks = BlockFileReader(path, FileKind::strip, 3).blocks();
    const auto entry = [](std::size_t block, std::size_t field) { return 40 + (3 - block) * 40 - 8 * field; };
    EXPECT_FALSE(refuses(entry(1, 0), 5)) << "any tag is legal";
    EXPECT_FALSE(refuses(entry(1, 1), blocks[1].offset));
    EXPECT_TRUE(refuses(entry(1, 1), blocks[0].offset)) << "two blocks in one place";
    EXPECT_TRUE(refuses(entry(1, 1), blocks[1].offset + 1)) << "a gap before a block";
    EXPECT_TRUE(refuses(entry(2, 1), ~std::uint64_t{0} - 8)) << "an offset that overflows";
    EXPECT_TRUE(refuses(entry(2, 2), 1)) << "a block into the index";
    EXPECT_TRUE(refuses(entry(2, 2), ~std::uint64_t{0} - 15)) << "a size that overflows";
    EXPECT_TRUE(refuses(entry(1, 2), blocks[1].stored_bytes - 1)) << "a gap after a block";
    EXPECT_TRUE(refuses(entry(0, 3), 999)) << "fewer bytes than the frame holds";
    EXPECT_TRUE(refuses(entry(0, 3), std::uint64_t{1} << 35)) << "more memory than the frame can fill";
    EXPECT_TRUE(refuses(entry(0, 3), ~std::uint64_t{0})) << "more bytes than any block";
    EXPECT_TRUE(refuses(entry(1, 3), 9)) << "a raw block of another size";
    EXPECT_TRUE(refuses(entry(1, 4), 1)) << "a raw block as a frame";
    EXPECT_TRUE(refuses(entry(1, 4), 2)) << "an unknown codec";
    EXPECT_TRUE(refuses(40, 47)) << "an index in the header";
    EXPECT_TRUE(refuses(40, blocks[2].offset)) << "an index that begins with a block";
    EXPECT_TRUE(refuses(40, ~std::uint64_t{0})) << "an index beyond the file";
    EXPECT_TRUE(refuses(32, 2)) << "fewer blocks than the index";
    EXPECT_TRUE(refuses(32, 4)) << "more blocks than the index";
    EXPECT_TRUE(refuses(32, 3 + (std::uint64_t{1} << 61))) << "a count whose bytes overflow";

    write_sample(path);  // the entries of two blocks change places
    Bytes bytes = read_file(path);
    std::swap_ranges(bytes.end() - 160, bytes.end() - 120, bytes.end() - 120);
    test::reseal(bytes);
    publish_file(path, bytes);
    EXPECT_TRUE(test::file_refused(path, [&] { read_all(path); })) << "an index out of order";
}

TEST(BlockFile, RejectsTrailersOfOtherBlocks) {
    const test::TemporaryFolder folder;
    {
        BlockFileWriter file(folder / "a", FileKind::strip, 3, key);
        for (std::uint64_t tag = 0; tag < 2; ++tag) file.append(tag, pattern(10), 0);
        file.publish();
    }
    const auto blocks = BlockFileReader(folder / "a", FileKind::strip, 3).blocks();
    Bytes bytes = read_file(folder / "a");
    const auto block = [&](std::size_t k) { return bytes.begin() + static_cast<std::ptrdiff_t>(blocks[k].offset); };
    std::swap_ranges(block(0), block(0) + 26, block(1));
    publish_file(folder / "a", bytes);
    EXPECT_TRUE(test::file_refused(folder / "a", [&] { read_all(folder / "a"); })) << "equal bytes under another tag";
}

TEST(BlockFile, RejectsNumberedBlocksOutOfOrderAndLongNames) {
    const test::TemporaryFolder folder;
    const auto write = [&](std::vector<std::uint64_t> tags, std::size_t name_bytes, std::uint8_t letter) {
        BlockFileWriter file(folder / "a", FileKind::strip, 3, key);
        for (const std::uint64_t tag : tags) file.append(tag, Bytes(name_bytes, letter), 0);
        file.publish();
    };
    const auto refuses = [&](std::size_t count) {
        const BlockFileReader file(folder / "a", FileKind::strip, 3);
        return test::file_refused(folder / "a", [&] { require_numbered_blocks(file, count), read_name(file, 0); });
    };
    write({0, 1, 2}, 64, 'x');
    EXPECT_FALSE(refuses(3));
    EXPECT_TRUE(refuses(2));
    EXPECT_TRUE(refuses(4));
    write({0, 2, 1}, 64, 'x');
    EXPECT_TRUE(refuses(3));
    write({0, 1, 1}, 64, 'x');
    EXPECT_TRUE(refuses(3));
    write({0}, 65, 'x');
    EXPECT_TRUE(refuses(1)) << "a long name";
    for (const int letter : {0, 31, 127, 200}) {
        write({0}, 3, static_cast<std::uint8_t>(letter));
        EXPECT_TRUE(refuses(1)) << "letter " << letter;
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
