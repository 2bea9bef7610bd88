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

/// Bytes that zstd keeps as they are, in a frame of their own, after the frame's size.
Bytes frame(const Bytes& bytes) {
    const auto size = static_cast<std::uint8_t>(bytes.size());
    Bytes all{static_cast<std::uint8_t>(9 + size),     0x28, 0xb5, 0x2f, 0xfd, 0x20, size,
              static_cast<std::uint8_t>(size * 8 + 1), 0,    0};
    all.insert(all.end(), bytes.begin(), bytes.end());
    return all;
}

Bytes joined(std::initializer_list<Bytes> parts) {
    Bytes all;
    for (const Bytes& part : parts) all.insert(all.end(), part.begin(), part.end());
    return all;
}

/// Code lengths of 1 for symbol 0 and `symbol`, which is divisible by 16, plus 1.
Bytes two_codes(std::uint8_t symbol) {
    Bytes halves{1};
    for (int run = 0; run < symbol / 16; ++run) halves.insert(halves.end(), {0, 15});
    halves.push_back(1);
    for (int run = symbol / 16; run < 15; ++run) halves.insert(halves.end(), {0, 15});
    halves.insert(halves.end(), {0, 13});
    Bytes bytes;
    for (std::size_t k = 0; k < halves.size(); k += 2)
        bytes.push_back(static_cast<std::uint8_t>(halves[k] | halves[k + 1] << 4));
    return bytes;
}

/// The document's example in its parts.
struct Example {
    std::uint8_t rows = 2, columns = 2, pairs = 1, classes = 1, symbol = 0x31;
    Bytes lanes{1, 0, 0, 0, 1}, sizes{1, 0}, large{};
    [[nodiscard]] Bytes bytes() const {
        return joined({{rows, columns, pairs, classes},
                       two_codes(symbol),
                       lanes,
                       frame(sizes),
                       large.empty() ? Bytes{} : frame(large)});
    }
};

TEST(GapSymbols, ExampleOfTheDocument) {
    const StripPairs block{2, 2, {0, 1, 1}, {1}, {3}};
    EXPECT_EQ(encode_gaps(block), Example{}.bytes());
    expect_equal(decode_gaps(Example{}.bytes(), true, "example"), block);
    const Bytes document{0x02, 0x02, 0x01, 0x01, 0x01, 0x0f, 0x0f, 0x1f, 0xf0, 0xf0, 0xf0, 0xf0, 0xf0,
                         0xf0, 0xf0, 0xf0, 0xf0, 0xf0, 0xf0, 0xf0, 0xd0, 0x01, 0x00, 0x00, 0x00, 0x01,
                         0x0b, 0x28, 0xb5, 0x2f, 0xfd, 0x20, 0x02, 0x11, 0x00, 0x00, 0x01, 0x00};
    EXPECT_EQ(encode_gaps(block), document);
}

TEST(GapSymbols, RoundTrip) {
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
            const Bytes bytes = encode_gaps(block);
            expect_equal(decode_gaps(bytes, diagonal, "round trip"), block);
            expect_equal(unpack_pairs(pack_pairs(block).stored, diagonal, "packed"), block);
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
    expect_equal(decode_gaps(encode_gaps(block), false, "escapes"), block);
}

TEST(GapSymbols, EmptyRowsInAnyNumber) {
    for (std::uint32_t before = 0; before < 40; ++before)
        for (const std::uint32_t after : {0u, 1u, 14u, 15u, 16u, 17u, 33u}) {
            StripPairs block{before + 1 + after, 5, {}, {3}, {1}};
            block.row_begin.assign(block.rows + 1, 1);
            std::fill(block.row_begin.begin(), block.row_begin.begin() + before + 1, 0u);
            expect_equal(decode_gaps(encode_gaps(block), false, "rows"), block);
        }
}

TEST(GapSymbols, LargeValuesOfEveryLength) {
    StripPairs block{3,
                     65536,
                     {0, 4, 4, 5},
                     {0, 144, 32784, 65535, 65535},
                     {14, 15 + 127, 15 + 128, 15 + 128 + 127 * 256 - 1, 15 + 128 + 127 * 256}};
    expect_equal(decode_gaps(encode_gaps(block), false, "large"), block);
    block.column[0] = 65532, block.column[1] = 65533, block.column[2] = 65534;
    block.count.back() = 0xffffffffu;
    expect_equal(decode_gaps(encode_gaps(block), false, "large"), block);
}

TEST(GapSymbols, BlocksOfOneClassAndOfFive) {
    std::mt19937_64 random(4);
    for (const std::size_t draws : {16000u, 24000u}) {
        const StripPairs block = test::random_pairs(300, 1000, draws, false, random);
        const Bytes bytes = encode_gaps(block);
        const std::size_t varint_bytes = block.column.size() < 1 << 14 ? 2 : 3;
        EXPECT_EQ(bytes[2 + 2 + varint_bytes], block.column.size() < 16384 ? 1 : 5);
        // Memory that is used again keeps nothing of what was there.
        StripPairs before{7, 7, std::vector<std::uint32_t>(2000, 9), std::vector<std::uint16_t>(70000, 9),
                          std::vector<std::uint32_t>(5, 9)};
        expect_equal(decode_gaps(bytes, false, "classes", std::move(before)), block);
    }
}

TEST(GapSymbols, RefusesEveryOtherLength) {
    std::mt19937_64 random(2);
    test::expect_exact_length(encode_gaps(test::random_pairs(9, 200, 60, false, random)), decode);
    test::expect_exact_length(encode_gaps(test::random_pairs(90, 90, 900, true, random)), decode_diagonal);
    test::expect_exact_length(Bytes(pack_pairs(test::random_pairs(90, 200, 900, false, random)).stored), unpack);
}

TEST(GapSymbols, RefusesDisorder) {
    EXPECT_FALSE(refused(Example{}.bytes(), decode_diagonal));
    EXPECT_TRUE(refused(Example{.rows = 0}.bytes(), decode)) << "no rows";
    EXPECT_TRUE(refused(Example{.columns = 0}.bytes(), decode)) << "no columns";
    EXPECT_TRUE(refused(Example{.columns = 1}.bytes(), decode)) << "a column beyond the block";
    EXPECT_TRUE(refused(Example{.pairs = 0}.bytes(), decode)) << "no pairs";
    EXPECT_TRUE(refused(Example{.pairs = 2}.bytes(), decode)) << "more pairs than lanes hold";
    EXPECT_TRUE(refused(Example{.rows = 3}.bytes(), decode)) << "more rows than stated";
    EXPECT_TRUE(refused(Example{.classes = 2}.bytes(), decode)) << "two classes";
    EXPECT_TRUE(refused(Example{.sizes = {2, 0}}.bytes(), decode)) << "more pairs than stated";
    EXPECT_TRUE(refused(Example{.sizes = {0, 0}}.bytes(), decode)) << "fewer pairs than stated";
    EXPECT_FALSE(refused(Example{.sizes = {0, 1}}.bytes(), decode)) << "(1, 1)";
    EXPECT_TRUE(refused(Example{.sizes = {0, 1}}.bytes(), decode_diagonal)) << "(1, 1) on the diagonal";
    EXPECT_TRUE(refused(Example{.lanes = {1, 0, 0, 0, 0}}.bytes(), decode)) << "a count of zero";
    EXPECT_TRUE(refused(Example{.large = {1}}.bytes(), decode)) << "a large value that nobody needs";
    EXPECT_TRUE(refused(Example{.symbol = 0xf1}.bytes(), decode)) << "no large value";
    EXPECT_FALSE(refused(Example{.symbol = 0xf1, .large = {1}}.bytes(), decode)) << "a count of 16";
    Bytes packed = joined({{2}, Example{}.bytes()});
    EXPECT_FALSE(refused(packed, unpack));
    packed[0] = 3;
    EXPECT_TRUE(refused(packed, unpack)) << "unknown codec";
}

TEST(GapSymbols, RefusesRowsThatRunOver) {
    // Two pairs in a row whose steps add up to 2^16 and to more: columns would begin again.
    StripPairs block{1, 65536, {0, 2}, {65000, 65535}, {1, 1}};
    Bytes bytes = encode_gaps(block);
    EXPECT_FALSE(refused(bytes, decode));
    const Bytes large{255, 129};
    const auto at = std::search(bytes.begin(), bytes.end(), large.begin(), large.end());
    ASSERT_NE(at, bytes.end());
    for (int first = 128; first < 255; ++first) {
        at[1] = static_cast<std::uint8_t>(first);
        EXPECT_EQ(refused(bytes, decode), first > 129) << first;
    }
}

TEST(GapSymbols, RandomBytesAreRefusedOrLegal) {
    std::mt19937_64 random(3);
    const Bytes whole = encode_gaps(test::random_pairs(20, 90, 100, true, random));
    for (int round = 0; round < 5000; ++round) {
        Bytes bytes = whole;
        for (std::uint64_t k = 0; k < 1 + random() % 3; ++k)
            bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
        refused(bytes, [](ByteView view) {
            const StripPairs block = decode_gaps(view, true, "random");
            expect_equal(decode_gaps(encode_gaps(block), true, "again"), block);
        });
    }
}

}  // namespace
}  // namespace luxel
