#include "formats/bake/gap_symbols.h"

#include <algorithm>
#include <bit>

#include "formats/bake/chained_code.h"
#include "formats/base/compress.h"

namespace luxel {
namespace {

constexpr std::uint64_t max_side = 65536;
constexpr std::uint32_t escape = 15;  ///< of a gap or a count: the rest is a large value
constexpr std::size_t group = 64;     ///< symbols that are looked through for escapes at once

constexpr std::size_t all_classes = 5;
/// Below this many pairs the codes of five classes cost more, in bytes and in time, than they save.
constexpr std::size_t least_pairs_for_classes = 16384;

/// By the count in the symbol before: 1, 2, 3 to 4, 5 to 8, more.
constexpr ClassAfter by_count() {
    ClassAfter classes{};
    for (std::size_t symbol = 0; symbol < classes.size(); ++symbol) {
        const std::size_t count = symbol >> 4;
        classes[symbol] = static_cast<std::uint8_t>(count <= 1   ? 0
                                                    : count == 2 ? 1
                                                    : count <= 4 ? 2
                                                    : count <= 8 ? 3
                                                                 : 4);
    }
    return classes;
}

const ClassAfter& class_after(std::size_t classes) {
    static constexpr ClassAfter one{}, five = by_count();
    return classes == 1 ? one : five;
}

/// Numbers of which most are small, in two parts: first bytes that are worth a code of their own, and what follows some
/// of them, which is noise.
struct Values {
    ByteWriter first, rest;
    void put(std::uint32_t value) {
        constexpr std::uint32_t one_byte = 128, two_bytes = one_byte + 127 * 256;
        if (value < one_byte) {
            first.put(static_cast<std::uint8_t>(value));
        } else if (value < two_bytes) {
            first.put(static_cast<std::uint8_t>(one_byte + (value - one_byte) / 256));
            rest.put(static_cast<std::uint8_t>((value - one_byte) % 256));
        } else {
            first.put(std::uint8_t{255});
            rest.put(value);
        }
    }
    void append(const Values& more) {
        first.put_array(std::span<const std::uint8_t>(more.first.bytes()));
        rest.put_array(std::span<const std::uint8_t>(more.rest.bytes()));
    }
    void write(ByteWriter& out) const {
        if (first.size() == 0) return;
        const Bytes frame = compress_literals(first.bytes());
        out.put_varint(frame.size());
        out.put_array(std::span<const std::uint8_t>(frame));
        out.put_array(std::span<const std::uint8_t>(rest.bytes()));
    }
};

/// The inverse: `count` numbers.
std::vector<std::uint32_t> get_values(ByteCursor& in, std::uint64_t count, const char* field,
                                      const std::string& where) {
    if (count == 0) return {};
    const std::uint64_t frame_bytes = in.get_varint(field);
    const Bytes first = decompress(in.get_view(frame_bytes, field), count, where);
    std::uint64_t long_numbers = 0, longest_numbers = 0;
    for (const std::uint8_t byte : first) long_numbers += byte >> 7, longest_numbers += byte == 255;
    const ByteView stored = in.get_view(long_numbers + 3 * longest_numbers, field);
    Bytes rest(stored.begin(), stored.end());
    rest.push_back(0);  // read, but not used, by numbers without a rest
    std::vector<std::uint32_t> values(count);
    const std::uint8_t* at = rest.data();
    for (std::size_t k = 0; k < count; ++k) {
        const std::uint32_t byte = first[k], has_rest = byte >> 7;
        values[k] = byte + has_rest * ((byte - 128) * 255 + *at);
        at += has_rest;
        if (byte < 255) continue;
        std::memcpy(&values[k], at - 1, sizeof values[k]);
        at += 3;
    }
    return values;
}

/// Bit k: are all four bits of the low half (half 0) or the high half (half 4) of symbol k of a group set?
std::uint64_t find_escapes(const std::uint8_t* symbols, int half) {
    constexpr std::uint64_t ones = 0x0101010101010101ULL;
    std::uint64_t found = 0;
    for (std::size_t word = 0; word < group / 8; ++word) {
        std::uint64_t bytes;
        std::memcpy(&bytes, symbols + 8 * word, sizeof bytes);
        // Adding 1 at the foot of the half carries into the bit above it; the product puts eight carries side by side.
        const std::uint64_t carries = ((bytes >> half & 15 * ones) + ones) >> 4 & ones;
        found |= (carries * 0x0102040810204080ULL >> 56) << (8 * word);
    }
    return found;
}

/// Calls body(index) for every symbol with an escape in that half, ascending; `group` zeros follow the symbols.
template <class Body>
void each_escape(const std::uint8_t* symbols, std::size_t count, int half, Body&& body) {
    for (std::size_t begin = 0; begin < count; begin += group)
        for (std::uint64_t found = find_escapes(symbols + begin, half); found; found &= found - 1)
            body(begin + static_cast<std::size_t>(std::countr_zero(found)));
}

/// The two halves of each symbol: steps to the next pair and counts. A function of its own for the sake of `restrict`.
[[gnu::noinline]] void split_symbols(const std::uint8_t* __restrict symbols, std::size_t count,
                                     std::uint16_t* __restrict steps, std::uint32_t* __restrict counts) {
    for (std::size_t k = 0; k < count; ++k) {
        steps[k] = static_cast<std::uint16_t>((symbols[k] & 15) + 1);
        counts[k] = symbols[k] >> 4;
    }
}

/// What a block's symbols say of it.
struct Census {
    std::size_t zeros = 0;    ///< symbols with a count of zero
    std::size_t escapes = 0;  ///< halves that a large value follows
};

Census take_census(const std::uint8_t* symbols, std::size_t count) {
    Census census;
    for (std::size_t begin = 0; begin < count; begin += 128) {
        std::uint8_t zeros = 0, escapes = 0;  // of 128 symbols: at most 256 escapes would not fit, so halves are apart
        std::uint8_t gap_escapes = 0;
        const std::size_t end = std::min(count, begin + 128);
        for (std::size_t k = begin; k < end; ++k) {
            zeros = static_cast<std::uint8_t>(zeros + (symbols[k] < 16));
            escapes = static_cast<std::uint8_t>(escapes + (symbols[k] >= 15 * 16));
            gap_escapes = static_cast<std::uint8_t>(gap_escapes + ((symbols[k] & 15) == 15));
        }
        census.zeros += zeros;
        census.escapes += std::size_t{escapes} + gap_escapes;
    }
    return census;
}

using Columns = std::uint16_t __attribute__((vector_size(16)));
constexpr std::size_t columns_width = sizeof(Columns) / sizeof(std::uint16_t);

/// Each the sum of itself and all before it, modulo 2^16.
inline Columns running_sum(Columns v) {
    const Columns none{};
    v += __builtin_shufflevector(none, v, 0, 8, 9, 10, 11, 12, 13, 14);
    v += __builtin_shufflevector(none, v, 0, 0, 8, 9, 10, 11, 12, 13);
    v += __builtin_shufflevector(none, v, 0, 0, 0, 0, 8, 9, 10, 11);
    return v;
}

inline Columns last_of(const Columns& v) { return __builtin_shufflevector(v, v, 7, 7, 7, 7, 7, 7, 7, 7); }

/// Steps -> their sums along the whole block, minus 1, modulo 2^16. `columns_width` values follow that may be
/// overwritten.
[[gnu::noinline]] void add_steps(std::uint16_t* steps, std::size_t count) {
    Columns sum = Columns{} - 1, v;
    for (std::size_t k = 0; k < count; k += columns_width) {
        std::memcpy(&v, steps + k, sizeof v);
        v = running_sum(v) + sum;
        std::memcpy(steps + k, &v, sizeof v);
        sum = last_of(v);
    }
}

/// Sums along the whole block -> sums along rows, by what the sum was where each row begins. `changes`: that, minus the
/// same of the row before, where a row begins, and 0 elsewhere. Both have `columns_width` values more.
[[gnu::noinline]] void restart_rows(const std::uint16_t* __restrict sums, const std::uint16_t* __restrict changes,
                                    std::size_t count, std::uint16_t* __restrict columns) {
    Columns base{}, v, change;
    for (std::size_t k = 0; k < count; k += columns_width) {
        std::memcpy(&change, changes + k, sizeof change);
        std::memcpy(&v, sums + k, sizeof v);
        change = running_sum(change) + base;
        v -= change;
        if (k + columns_width <= count)
            std::memcpy(columns + k, &v, sizeof v);
        else
            std::memcpy(columns + k, &v, (count - k) * sizeof(std::uint16_t));
        base = last_of(change);
    }
}

/// Sizes -> begins of rows; false if they are not those of all pairs.
bool begin_rows(std::span<const std::uint32_t> sizes, std::uint64_t pairs, std::vector<std::uint32_t>& begins) {
    begins.resize(sizes.size() + 1);
    std::uint64_t sum = 0;
    for (std::size_t row = 0; row < sizes.size(); ++row) {
        begins[row] = static_cast<std::uint32_t>(sum);
        sum += sizes[row];
    }
    begins.back() = static_cast<std::uint32_t>(sum);
    return sum == pairs;
}

/// Are columns in range and ascending in each row? Counts where they do not ascend at all, and where a row may begin.
bool columns_are_legal(const StripPairs& block, bool diagonal) {
    const std::uint16_t* const column = block.column.data();
    const std::size_t pairs = block.column.size();
    std::uint16_t largest = column[0];
    std::uint32_t descents = 0;
    for (std::size_t k = 1; k < pairs; ++k) {
        largest = largest < column[k] ? column[k] : largest;
        descents += column[k] <= column[k - 1];
    }
    std::uint32_t allowed = 0, below_diagonal = 0;
    for (std::uint32_t row = 0; row < block.rows; ++row) {
        const std::uint32_t begin = block.row_begin[row];
        if (begin == block.row_begin[row + 1]) continue;
        if (begin > 0) allowed += column[begin] <= column[begin - 1];
        below_diagonal += column[begin] <= row;
    }
    return largest < block.columns && descents == allowed && !(diagonal && below_diagonal);
}

/// Columns and counts from symbols and large values; rows are known.
void read_pairs(const std::uint8_t* symbols, std::span<const std::uint32_t> large, const ByteCursor& in,
                StripPairs& block) {
    const std::size_t pairs = block.column.size();
    const auto steps = std::make_unique_for_overwrite<std::uint16_t[]>(pairs + columns_width);
    std::uint32_t* const counts = block.count.data();
    split_symbols(symbols, pairs, steps.get(), counts);
    const std::uint32_t* next = large.data();
    std::uint64_t too_large = 0;
    each_escape(symbols, pairs, 0, [&](std::size_t k) {
        const std::uint64_t gap = std::uint64_t{escape} + *next++;
        too_large |= gap >> 16;
        steps[k] = static_cast<std::uint16_t>(gap + 1);
    });
    each_escape(symbols, pairs, 4, [&](std::size_t k) {
        const std::uint64_t count = std::uint64_t{escape} + *next++;
        too_large |= count >> 32;
        counts[k] = static_cast<std::uint32_t>(count);
    });
    if (too_large) in.fail("large values", "a gap above 2^16 or a count above 2^32");
    add_steps(steps.get(), pairs);
    const auto changes = std::make_unique<std::uint16_t[]>(pairs + columns_width);
    std::uint16_t base = 0;
    for (std::size_t row = 0; row < block.rows; ++row) {
        const std::uint32_t begin = block.row_begin[row];
        if (begin == 0 || begin == block.row_begin[row + 1]) continue;
        const auto sum = static_cast<std::uint16_t>(steps[begin - 1] + 1);
        changes[begin] = static_cast<std::uint16_t>(sum - base);
        base = sum;
    }
    restart_rows(steps.get(), changes.get(), pairs, block.column.data());
}

}  // namespace

Bytes encode_gaps(const StripPairs& block) {
    Bytes symbols;
    symbols.reserve(block.column.size());
    Values sizes, large, large_counts;
    for (std::uint32_t row = 0; row < block.rows; ++row) {
        const std::uint32_t begin = block.row_begin[row], end = block.row_begin[row + 1];
        sizes.put(end - begin);
        std::uint32_t next = 0;
        for (std::uint32_t k = begin; k < end; ++k) {
            const std::uint32_t gap = block.column[k] - next;
            symbols.push_back(static_cast<std::uint8_t>(std::min(block.count[k], escape) << 4 | std::min(gap, escape)));
            if (gap >= escape) large.put(gap - escape);
            if (block.count[k] >= escape) large_counts.put(block.count[k] - escape);
            next = block.column[k] + 1u;
        }
    }
    large.append(large_counts);
    const std::size_t classes = symbols.size() < least_pairs_for_classes ? 1 : all_classes;
    ByteWriter out;
    out.put_varint(block.rows);
    out.put_varint(block.columns);
    out.put_varint(block.column.size());
    out.put(static_cast<std::uint8_t>(classes));
    put_symbols(out, symbols, class_after(classes));
    sizes.write(out);
    large.write(out);
    return out.take();
}

StripPairs decode_gaps(ByteView bytes, bool diagonal, const std::string& where, StripPairs reuse) {
    ByteCursor in(bytes, where);
    const std::uint64_t rows = in.get_varint("rows"), columns = in.get_varint("columns"),
                        pairs = in.get_varint("pair count");
    if (rows == 0 || rows > max_side || columns == 0 || columns > max_side) in.fail("size", "not in 1 .. 65536");
    if (pairs == 0 || pairs > rows * columns || pairs > 0xffffffffu) in.fail("pair count", "zero or more than the block holds");
    const std::size_t classes = in.get<std::uint8_t>("classes");
    if (classes != 1 && classes != all_classes) in.fail("classes", "neither 1 nor 5");
    const auto symbols = get_symbols(in, pairs, group, class_after(classes));
    const Census census = take_census(symbols.get(), pairs);
    if (census.zeros > 0) in.fail("symbols", "a count of zero");
    const std::vector<std::uint32_t> sizes = get_values(in, rows, "row sizes", where);
    const std::vector<std::uint32_t> large = get_values(in, census.escapes, "large values", where);
    in.expect_end("strip block");

    StripPairs block = std::move(reuse);
    block.rows = static_cast<std::uint32_t>(rows);
    block.columns = static_cast<std::uint32_t>(columns);
    if (!begin_rows(sizes, pairs, block.row_begin)) in.fail("row sizes", "their sum is not the number of pairs");
    block.column.resize(pairs);
    block.count.resize(pairs);
    read_pairs(symbols.get(), large, in, block);
    if (!columns_are_legal(block, diagonal)) in.fail("symbols", "a pair lies beyond the block");
    return block;
}

}  // namespace luxel
