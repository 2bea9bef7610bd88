/// Gap symbols: pinned bytes of strip_file.md, round trip at all sizes, refusal of damage; and the choice of a codec.
#include "formats/bake/gap_symbols.h"

#include <gtest/gtest.h>

#include "tests/support/damage.h"
#include "tests/unit/bake_files/made_strips.h"

namespace luxel {
namespace {

using test::expect_equal;
using test::refused;

void decode(ByteView bytes) { decode_gaps(bytes, false, "test"); }
void decode_diagonal(ByteView bytes) { decode_gaps(bytes, true, "test"); }
void unpack(ByteView bytes) { unpack_pairs(bytes, false, "test"); }

/// A frame of zstd that holds one byte as it is.
Bytes one_byte_stream(std::uint8_t byte) { return {1, 10, 0x28, 0xb5, 0x2f, 0xfd, 0x20, 1, 9, 0, 0, byte}; }

Bytes joined(std::initializer_list<Bytes> parts) {
    Bytes all;
    for (const Bytes& part : parts) all.insert(all.end(), part.begin(), part.end());
    return all;
}

/// The document's example: rows, columns, pairs; class 0, 1, 2, 3, 4; large values.
Bytes example(std::uint8_t rows, std::uint8_t pairs, std::uint8_t pair, std::uint8_t end) {
    return joined({{rows, 2, pairs}, one_byte_stream(pair), {0}, one_byte_stream(end), {0, 0}, {0}});
}

TEST(GapSymbols, ExampleOfTheDocument) {
    const StripPairs block{2, 2, {0, 1, 1}, {1}, {3}};
    EXPECT_EQ(encode_gaps(block, true), example(2, 1, 0x30, 0x01));
    expect_equal(decode_gaps(example(2, 1, 0x30, 0x01), true, "example"), block);
}

TEST(GapSymbols, RoundTrip) {
    std::mt19937_64 random(1);
    struct Size {
        std::uint32_t rows, columns;
        std::size_t pairs;
    };
    for (const Size& size : {Size{1, 1, 1}, Size{1, 64, 40}, Size{3, 65, 5}, Size{63, 64, 4000}, Size{64, 63, 9}, Size{100, 130, 13000},
                             Size{2048, 2048, 30000}, Size{5, 65536, 2000}, Size{65536, 3, 2000}, Size{65536, 1, 1}, Size{1, 65536, 200000}})
        for (const bool diagonal : {false, true}) {
            const StripPairs block = test::random_pairs(size.rows, size.columns, size.pairs, diagonal, random);
            if (block.column.empty()) continue;
            const Bytes bytes = encode_gaps(block, diagonal);
            expect_equal(decode_gaps(bytes, diagonal, "round trip"), block);
            expect_equal(unpack_pairs(pack_pairs(block, diagonal).stored, diagonal, "packed"), block);
        }
}

TEST(GapSymbols, EveryGapAndCountAroundTheEscapes) {
    StripPairs block{40, 4000, {0}, {}, {}};
    for (std::uint32_t row = 0; row < block.rows; ++row) {
        for (std::uint32_t k = 0, column = row; k < 20; ++k, column += row + 1) {
            block.column.push_back(static_cast<std::uint16_t>(column));
            block.count.push_back(k == 19 ? 0xffffffffu : row + k + 1);
        }
        block.row_begin.push_back(static_cast<std::uint32_t>(block.column.size()));
    }
    expect_equal(decode_gaps(encode_gaps(block, false), false, "escapes"), block);
}

TEST(GapSymbols, EmptyRowsInAnyNumber) {
    for (std::uint32_t before = 0; before < 40; ++before)
        for (const std::uint32_t after : {0u, 1u, 14u, 15u, 16u, 17u, 33u}) {
            StripPairs block{before + 1 + after, 5, {}, {3}, {1}};
            block.row_begin.assign(block.rows + 1, 1);
            std::fill(block.row_begin.begin(), block.row_begin.begin() + before + 1, 0u);
            expect_equal(decode_gaps(encode_gaps(block, false), false, "rows"), block);
        }
}

TEST(GapSymbols, RefusesEveryOtherLength) {
    std::mt19937_64 random(2);
    test::expect_exact_length(encode_gaps(test::random_pairs(9, 200, 60, false, random), false), decode);
    test::expect_exact_length(encode_gaps(test::random_pairs(90, 90, 900, true, random), true), decode_diagonal);
    test::expect_exact_length(Bytes(pack_pairs(test::random_pairs(90, 200, 900, false, random), false).stored), unpack);
}

TEST(GapSymbols, RefusesDisorder) {
    EXPECT_FALSE(refused(example(2, 1, 0x30, 0x01), decode_diagonal));
    EXPECT_FALSE(refused(example(2, 1, 0x31, 0x01), decode)) << "(0, 1) where columns begin with 0";
    EXPECT_TRUE(refused(example(0, 1, 0x30, 0x01), decode_diagonal)) << "no rows";
    EXPECT_TRUE(refused(example(2, 0, 0x30, 0x01), decode_diagonal)) << "no pairs";
    EXPECT_TRUE(refused(example(2, 2, 0x30, 0x01), decode_diagonal)) << "fewer pairs than stated";
    EXPECT_TRUE(refused(example(1, 1, 0x30, 0x01), decode_diagonal)) << "more rows than stated";
    EXPECT_TRUE(refused(example(3, 1, 0x30, 0x01), decode_diagonal)) << "fewer rows than stated";
    EXPECT_TRUE(refused(example(2, 1, 0x31, 0x01), decode_diagonal)) << "a column beyond the block";
    EXPECT_TRUE(refused(example(2, 1, 0x3f, 0x01), decode_diagonal)) << "a large gap that is not there";
    EXPECT_TRUE(refused(example(2, 1, 0xf0, 0x01), decode_diagonal)) << "a large count that is not there";
    EXPECT_TRUE(refused(example(2, 1, 0x10, 0x01), decode_diagonal)) << "the next class has no symbols, another has some left";
    EXPECT_TRUE(refused(example(2, 1, 0x01, 0x01), decode_diagonal)) << "no pairs at all";
    Bytes packed = joined({{3}, example(2, 1, 0x30, 0x01)});
    EXPECT_FALSE(refused(packed, [](ByteView bytes) { unpack_pairs(bytes, true, "test"); }));
    EXPECT_TRUE(refused(packed, unpack)) << "a block of the diagonal in another place";
    packed[0] = 4;
    EXPECT_TRUE(refused(packed, unpack)) << "unknown codec";
}

TEST(GapSymbols, RandomBytesAreRefusedOrLegal) {
    std::mt19937_64 random(3);
    const Bytes whole = encode_gaps(test::random_pairs(20, 90, 100, true, random), true);
    for (int round = 0; round < 5000; ++round) {
        Bytes bytes = whole;
        for (std::uint64_t k = 0; k < 1 + random() % 3; ++k) bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
        refused(bytes, [](ByteView view) {
            const StripPairs block = decode_gaps(view, true, "random");
            expect_equal(decode_gaps(encode_gaps(block, true), true, "again"), block);
        });
    }
}

}  // namespace
}  // namespace luxel
