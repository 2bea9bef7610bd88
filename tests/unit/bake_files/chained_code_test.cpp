/// Symbols in lanes: round trip of any distribution and number, the bound of code lengths, refusal of damage.
#include "formats/bake/chained_code.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/support/damage.h"

namespace luxel {
namespace {

using test::refused;

constexpr ClassAfter one_class{};

ClassAfter classes_of_eight() {
    ClassAfter classes{};
    for (std::size_t s = 0; s < classes.size(); ++s) classes[s] = static_cast<std::uint8_t>(s % 8);
    return classes;
}

Bytes encoded(const Bytes& symbols, const ClassAfter& classes) {
    ByteWriter out;
    put_symbols(out, symbols, classes);
    return out.take();
}

Bytes decoded(ByteView bytes, std::size_t count, const ClassAfter& classes) {
    ByteCursor in(bytes, "test");
    constexpr std::size_t slack = 5;
    const auto symbols = get_symbols(in, count, slack, classes);
    in.expect_end("symbols");
    for (std::size_t k = 0; k < slack; ++k) EXPECT_EQ(symbols[count + k], 0);
    return {symbols.get(), symbols.get() + count};
}

/// Symbol s with a probability of about ratio^s.
Bytes geometric(std::size_t count, double ratio, std::mt19937_64& random) {
    Bytes symbols(count);
    for (std::uint8_t& symbol : symbols) {
        const double u = (static_cast<double>(random() >> 11) + 0.5) * 0x1p-53;
        symbol = static_cast<std::uint8_t>(std::min(255.0, std::log(u) / std::log(ratio)));
    }
    return symbols;
}

TEST(ChainedCode, RoundTrip) {
    std::mt19937_64 random(1);
    for (const ClassAfter& classes : {one_class, classes_of_eight()})
        for (const double ratio : {0.001, 0.3, 0.9, 0.999999})
            for (const std::size_t count : {1u, 2u, 3u, 4u, 5u, 19u, 20u, 21u, 23u, 40u, 1000u, 100001u}) {
                const Bytes symbols = geometric(count, ratio, random);
                EXPECT_EQ(decoded(encoded(symbols, classes), count, classes), symbols) << ratio << ", " << count;
            }
}

TEST(ChainedCode, IsNearTheEntropy) {
    // Symbols of class c are uniform among 2^(c % 3 + 1): a code without classes would need more bits.
    std::mt19937_64 random(2);
    const ClassAfter classes = classes_of_eight();
    Bytes symbols(40000);
    double bits = 0;
    std::size_t before = 0;
    for (std::size_t k = 0; k < symbols.size(); ++k) {
        if (k % (symbols.size() / lane_count) == 0) before = 0;
        symbols[k] = static_cast<std::uint8_t>(before + (random() % (2u << before % 3)) * 37);
        bits += static_cast<double>(before % 3 + 1);
        before = classes[symbols[k]];
    }
    const double bytes = static_cast<double>(encoded(symbols, classes).size());
    EXPECT_GT(bytes, bits / 8);
    EXPECT_LT(bytes, bits / 8 + 400);
}

TEST(ChainedCode, CodesThatWouldBeTooLong) {
    // Fibonacci numbers of each symbol: an unbounded Huffman code has one bit more for each of them.
    Bytes symbols;
    for (std::size_t s = 0, a = 1, b = 1; s < 22; ++s) {
        symbols.insert(symbols.end(), a, static_cast<std::uint8_t>(s));
        const std::size_t next = a + b;
        a = b, b = next;
    }
    const Bytes bytes = encoded(symbols, one_class);
    EXPECT_EQ(decoded(bytes, symbols.size(), one_class), symbols);
    // The bound costs little: the unbounded code takes 2.62 bits a symbol.
    EXPECT_LT(static_cast<double>(bytes.size()), 2.65 / 8 * static_cast<double>(symbols.size()) + 30);
}

TEST(ChainedCode, RefusesEveryOtherLength) {
    std::mt19937_64 random(3);
    const ClassAfter classes = classes_of_eight();
    const Bytes symbols = geometric(200, 0.8, random), bytes = encoded(symbols, classes);
    test::expect_exact_length(bytes, [&](ByteView view) { decoded(view, 200, classes); });
    for (const std::size_t count : {1u, 100u, 150u, 300u, 100000u})
        EXPECT_TRUE(refused(bytes, [&](ByteView view) { decoded(view, count, classes); })) << count;
}

TEST(ChainedCode, RefusesIncompleteCodes) {
    const Bytes whole = encoded(Bytes{7, 7, 9, 7}, one_class);
    const auto decode = [](ByteView view) { decoded(view, 4, one_class); };
    EXPECT_FALSE(refused(whole, decode));
    ASSERT_EQ(whole[0], 0x60) << "seven symbols without a code";
    ASSERT_EQ(whole[1], 0x01) << "symbol 7 has a code of one bit, symbol 8 has none";
    for (const int length : {0, 2, 3, 11, 15}) {
        Bytes bytes = whole;
        bytes[1] = static_cast<std::uint8_t>(length);
        EXPECT_TRUE(refused(bytes, decode)) << length;
    }
}

TEST(ChainedCode, RandomBytesAreRefusedOrLegal) {
    std::mt19937_64 random(4);
    const ClassAfter classes = classes_of_eight();
    const Bytes whole = encoded(geometric(300, 0.7, random), classes);
    std::size_t legal = 0;
    for (int round = 0; round < 5000; ++round) {
        Bytes bytes = whole;
        for (std::uint64_t k = 0; k < 1 + random() % 3; ++k)
            bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
        legal += !refused(bytes, [&](ByteView view) {
            const Bytes symbols = decoded(view, 300, classes);
            EXPECT_EQ(decoded(encoded(symbols, classes), 300, classes), symbols);
        });
    }
    EXPECT_GT(legal, 0u);
    EXPECT_LT(legal, 5000u);
}

}  // namespace
}  // namespace luxel
