/// Strip files: pinned bytes of strip_file.md, round trip at all sizes, the rule of the diagonal, refusal of damage.
#include "formats/bake/strip_file.h"

#include <gtest/gtest.h>

#include "tests/support/damage.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/bake_files/made_strips.h"

namespace luxel {
namespace {

using test::expect_equal;
using test::refused;

void decode(ByteView bytes) { decode_counts(bytes, false, "test"); }
void decode_diagonal(ByteView bytes) { decode_counts(bytes, true, "test"); }

const Bytes example{2, 2, 1, 1, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 3};

TEST(StripFile, ExampleOfTheDocument) {
    const StripPairs block{2, 2, {0, 1, 1}, {1}, {3}};
    EXPECT_EQ(encode_counts(block), example);
    expect_equal(decode_counts(example, true, "example"), block);
}

TEST(StripFile, RoundTrip) {
    std::mt19937_64 random(1);
    struct Size {
        std::uint32_t rows, columns;
        std::size_t pairs;
    };
    for (const Size& size : {Size{1, 1, 1}, Size{1, 64, 40}, Size{3, 65, 5}, Size{63, 64, 4000}, Size{64, 63, 9},
                             Size{100, 130, 13000}, Size{2048, 2048, 30000}, Size{5, 65536, 2000}, Size{65536, 3, 2000},
                             Size{65536, 1, 1}, Size{1, 65536, 200000}})
        for (const bool diagonal : {false, true}) {
            const StripPairs block = test::random_pairs(size.rows, size.columns, size.pairs, diagonal, random);
            if (block.column.empty()) continue;
            expect_equal(decode_counts(encode_counts(block), diagonal, "round trip"), block);
        }
}

TEST(StripFile, FullBlock) {
    StripPairs block{70, 70, {0}, {}, {}};
    for (std::uint32_t row = 0; row < 70; ++row) {
        for (std::uint16_t column = 0; column < 70; ++column) block.column.push_back(column), block.count.push_back(1);
        block.row_begin.push_back(static_cast<std::uint32_t>(block.column.size()));
    }
    const Bytes bytes = encode_counts(block);
    expect_equal(decode_counts(bytes, false, "full"), block);
    EXPECT_TRUE(refused(bytes, decode_diagonal));
}

TEST(StripFile, OnlyColumnsAboveTheRowOnTheDiagonal) {
    for (std::uint16_t column = 0; column < 3; ++column) {
        const StripPairs block{3, 3, {0, 0, 1, 1}, {column}, {9}};  // row 1
        EXPECT_FALSE(refused(encode_counts(block), decode));
        EXPECT_EQ(refused(encode_counts(block), decode_diagonal), column <= 1) << column;
    }
}

TEST(StripFile, EmptyRowsCostNothing) {
    const StripPairs alone{1, 2048, {0, 1}, {77}, {1}};
    StripPairs among{2048, 2048, {}, {77}, {1}};
    among.row_begin.assign(2049, 1);
    among.row_begin[0] = 0;
    EXPECT_LE(encode_counts(among).size(), encode_counts(alone).size() + 2048 / 16 + 8);
}

TEST(StripFile, RefusesEveryOtherLength) {
    std::mt19937_64 random(2);
    test::expect_exact_length(example, decode_diagonal);
    test::expect_exact_length(encode_counts(test::random_pairs(9, 200, 60, false, random)), decode);
}

TEST(StripFile, RefusesDisorder) {
    const auto changed = [](std::size_t at, std::uint8_t value) {
        Bytes bytes = example;
        bytes.at(at) = value;
        return bytes;
    };
    EXPECT_TRUE(refused(changed(0, 0), decode)) << "no rows";
    EXPECT_TRUE(refused(changed(1, 0), decode)) << "no columns";
    EXPECT_TRUE(refused(changed(2, 0), decode)) << "no pairs";
    EXPECT_TRUE(refused(changed(2, 2), decode)) << "more pairs than bits";
    EXPECT_TRUE(refused(changed(2, 5), decode)) << "more pairs than places";
    EXPECT_TRUE(refused(changed(3, 2), decode)) << "a word of word bits beyond the block";
    EXPECT_TRUE(refused(changed(11, 4), decode)) << "a word of pair bits beyond the block";
    EXPECT_TRUE(refused(changed(19, 4), decode)) << "a column beyond the block";
    EXPECT_TRUE(refused(changed(19, 3), decode)) << "more bits than pairs";
    EXPECT_TRUE(refused(changed(19, 0), decode)) << "an empty pair word is stored";
    EXPECT_TRUE(refused(changed(11, 0), decode)) << "an empty word of word bits is stored";
    EXPECT_TRUE(refused(changed(27, 0), decode)) << "a count of zero";
    EXPECT_FALSE(refused(changed(27, 4), decode)) << "any count is legal";
    EXPECT_FALSE(refused(changed(19, 1), decode)) << "the pair (0, 0) is legal off the diagonal";
}

TEST(StripFile, RefusesSizesAbove65536) {
    for (const bool wide : {false, true}) {
        ByteWriter out;
        out.put_varint(wide ? 1 : 65537);
        out.put_varint(wide ? 65537 : 1);
        out.put_varint(1);
        for (int k = 0; k < 200; ++k) out.put(std::uint64_t{1});
        EXPECT_TRUE(refused(out.bytes(), decode));
    }
}

TEST(StripFile, RandomBytesAreRefusedOrLegal) {
    std::mt19937_64 random(3);
    const Bytes whole = encode_counts(test::random_pairs(20, 90, 100, true, random));
    for (int round = 0; round < 5000; ++round) {
        Bytes bytes = whole;
        for (std::uint64_t k = 0; k < 1 + random() % 3; ++k)
            bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
        refused(bytes, [](ByteView view) {
            const StripPairs block = decode_counts(view, true, "random");
            expect_equal(decode_counts(encode_counts(block), true, "again"), block);
        });
    }
}

const Key key{1, 2};

RayTallies tallies_of(std::uint32_t count) {
    RayTallies tallies;
    for (std::uint32_t k = 0; k < count; ++k) {
        tallies.rays.push_back(100 + k);
        tallies.self.push_back(k);
        tallies.open.push_back(2 * k);
        tallies.back.push_back(3 * k);
    }
    return tallies;
}

TEST(StripFile, WholeFileRoundTrip) {
    const test::TemporaryFolder folder;
    std::mt19937_64 random(4);
    const StripPairs first = test::random_pairs(10, 10, 30, true, random);
    const StripPairs second = test::random_pairs(10, 70, 300, false, random);
    StripWriter writer(folder / "strip", key, tallies_of(10));
    writer.append(3, first.column.size(), pack_pairs(first));
    writer.append(8, second.column.size(), pack_pairs(second));
    EXPECT_FALSE(std::filesystem::exists(folder / "strip")) << "nothing before it is published";
    writer.publish();

    const BlockFileReader file(folder / "strip", FileKind::strip, strip_version, &key);
    const RayTallies tallies = read_tallies(file);
    EXPECT_EQ(tallies.rays, tallies_of(10).rays);
    EXPECT_EQ(tallies.self, tallies_of(10).self);
    EXPECT_EQ(tallies.open, tallies_of(10).open);
    EXPECT_EQ(tallies.back, tallies_of(10).back);
    const auto directory = read_strip_directory(file);
    ASSERT_EQ(directory.size(), 2u);
    EXPECT_EQ(directory[0].b, 3u);
    EXPECT_EQ(directory[0].pair_count, first.column.size());
    EXPECT_EQ(directory[1].b, 8u);
    expect_equal(unpack_pairs(file.read(first_pair_block), true, "first"), first);
    expect_equal(unpack_pairs(file.read(first_pair_block + 1), false, "second"), second);
}

TEST(StripFile, RefusesFilesThatDoNotAddUp) {
    const test::TemporaryFolder folder;
    const auto damaged = [&](const RayTallies& tallies, std::vector<StripBlockInfo> directory, std::size_t blocks) {
        BlockFileWriter file(folder / "strip", FileKind::strip, strip_version, key);
        append_column<std::uint32_t>(file, 0, tallies.rays);
        append_column<std::uint32_t>(file, 1, tallies.self);
        append_column<std::uint32_t>(file, 2, tallies.open);
        append_column<std::uint32_t>(file, 3, tallies.back);
        ByteWriter out;
        out.put(static_cast<std::uint64_t>(directory.size()));
        for (const StripBlockInfo& info : directory) out.put(info.b), out.put(info.pair_count);
        file.append(4, out.bytes());
        for (std::size_t k = 0; k < blocks; ++k) file.append(5 + k, example);
        file.publish();
        const BlockFileReader reader(folder / "strip", FileKind::strip, strip_version, &key);
        return refused({}, [&](ByteView) { read_tallies(reader), read_strip_directory(reader); });
    };
    EXPECT_FALSE(damaged(tallies_of(2), {{0, 1}, {1, 1}}, 2));
    EXPECT_TRUE(damaged(tallies_of(2), {{1, 1}, {1, 1}}, 2)) << "the same block twice";
    EXPECT_TRUE(damaged(tallies_of(2), {{1, 1}, {0, 1}}, 2)) << "out of order";
    EXPECT_TRUE(damaged(tallies_of(2), {{0, 1}}, 2)) << "more blocks than the directory says";
    EXPECT_TRUE(damaged(tallies_of(2), {{0, 1}, {1, 1}}, 1)) << "fewer blocks than the directory says";
    RayTallies uneven = tallies_of(2);
    uneven.back.pop_back();
    EXPECT_TRUE(damaged(uneven, {}, 0)) << "tallies of different lengths";

    BlockFileWriter(folder / "short", FileKind::strip, strip_version, key).publish();
    const BlockFileReader reader(folder / "short", FileKind::strip, strip_version, &key);
    EXPECT_TRUE(refused({}, [&](ByteView) { read_tallies(reader); })) << "no blocks at all";
}

}  // namespace
}  // namespace luxel
