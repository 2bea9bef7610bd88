#include "formats/bake/gap_symbols.h"

#include <algorithm>
#include <array>

#include "formats/base/compress.h"

namespace luxel {
namespace {

constexpr std::uint64_t max_side = 65536;
constexpr std::uint32_t escape = 15;      ///< of a gap or a count: the rest is a varint
constexpr std::uint32_t most_empty = 15;  ///< empty rows that the end of a row can hold
constexpr std::size_t class_count = 5;
/// Class of the count before: none (start of a row), 1, 2 to 3, 4 to 8, more. Index: the count's nibble.
constexpr std::array<std::uint8_t, 16> class_of{0, 1, 2, 2, 3, 3, 3, 3, 3, 4, 4, 4, 4, 4, 4, 4};

/// A stream that is compressed in one frame: varint raw bytes, varint frame bytes, frame. Empty: one 0.
void put_stream(ByteWriter& out, const Bytes& stream) {
    out.put_varint(stream.size());
    if (stream.empty()) return;
    const Bytes frame = compress_literals(stream);
    out.put_varint(frame.size());
    out.put_array(std::span<const std::uint8_t>(frame));
}

/// Appends a byte 0, which a decoder meets when a stream ends too early.
Bytes get_stream(ByteCursor& in, std::uint64_t most_bytes, const char* field, const std::string& where) {
    const std::uint64_t raw_bytes = in.get_varint(field);
    if (raw_bytes > most_bytes) in.fail(field, "stream is longer than the block allows");
    Bytes stream;
    if (raw_bytes > 0) {
        const std::uint64_t frame_bytes = in.get_varint(field);
        decompress_into(in.get_view(frame_bytes, field), raw_bytes, where, 1, stream);
    }
    stream.push_back(0);
    return stream;
}

/// The streams of a block while it is read.
struct Streams {
    std::array<Bytes, class_count> symbols;
    std::array<const std::uint8_t*, class_count> next{}, end{};
};

}  // namespace

Bytes encode_gaps(const StripPairs& block, bool diagonal) {
    std::array<ByteWriter, class_count> symbols;
    ByteWriter large;
    for (std::uint32_t row = 0; row < block.rows;) {
        std::uint32_t column = diagonal ? row + 1 : 0;
        std::uint8_t before = 0;
        for (std::uint32_t k = block.row_begin[row]; k < block.row_begin[row + 1]; ++k) {
            const std::uint32_t gap = std::min(block.column[k] - column, escape), count = std::min(block.count[k], escape);
            symbols[before].put(static_cast<std::uint8_t>(count << 4 | gap));
            if (gap == escape) large.put_varint(block.column[k] - column - escape);
            if (count == escape) large.put_varint(block.count[k] - escape);
            before = class_of[count];
            column = block.column[k] + 1u;
        }
        std::uint32_t empty = 0;
        while (empty < most_empty && row + empty + 1 < block.rows &&
               block.row_begin[row + empty + 1] == block.row_begin[row + empty + 2])
            ++empty;
        symbols[before].put(static_cast<std::uint8_t>(empty));
        row += 1 + empty;
    }
    ByteWriter out;
    out.put_varint(block.rows);
    out.put_varint(block.columns);
    out.put_varint(block.column.size());
    for (ByteWriter& stream : symbols) put_stream(out, stream.take());
    put_stream(out, large.take());
    return out.take();
}

StripPairs decode_gaps(ByteView bytes, bool diagonal, const std::string& where) {
    ByteCursor in(bytes, where);
    const std::uint64_t rows = in.get_varint("rows"), columns = in.get_varint("columns"), pairs = in.get_varint("pair count");
    if (rows == 0 || rows > max_side || columns == 0 || columns > max_side) in.fail("size", "not in 1 .. 65536");
    if (pairs == 0 || pairs > rows * columns || pairs > 0xffffffffu)
        in.fail("pair count", "zero or more than the block holds");
    Streams streams;
    std::uint64_t symbol_count = 0;
    for (std::size_t c = 0; c < class_count; ++c) {
        streams.symbols[c] = get_stream(in, pairs + rows - symbol_count, "symbols", where);
        symbol_count += streams.symbols[c].size() - 1;
        streams.next[c] = streams.symbols[c].data();
        streams.end[c] = streams.next[c] + streams.symbols[c].size() - 1;
    }
    if (symbol_count < pairs) in.fail("symbols", "fewer than pairs");
    const Bytes large_bytes = get_stream(in, 10 * pairs, "large values", where);
    in.expect_end("strip block");
    ByteCursor large({large_bytes.data(), large_bytes.size() - 1}, where + ": large values");

    StripPairs block{static_cast<std::uint32_t>(rows), static_cast<std::uint32_t>(columns), {}, {}, {}};
    block.row_begin.resize(rows + 1);
    block.column.resize(pairs);
    block.count.resize(pairs);
    std::uint64_t row = 0, k = 0, column = diagonal ? 1 : 0;
    std::size_t before = 0;
    while (row < rows) {
        const std::uint32_t symbol = *streams.next[before]++;
        const std::uint32_t nibble = symbol >> 4;
        if (nibble == 0) {
            if (streams.next[before] > streams.end[before]) large.fail("symbols", "a stream ends too early");
            if (row + 1 + symbol > rows) large.fail("symbols", "more rows than the block has");
            for (const std::uint64_t end = row + 1 + symbol; row < end;) block.row_begin[++row] = static_cast<std::uint32_t>(k);
            column = diagonal ? row + 1 : 0;
            before = 0;
            continue;
        }
        std::uint64_t gap = symbol & 15, count = nibble;
        if (gap == escape) {
            const std::uint64_t rest = large.get_varint("gap");
            if (rest > max_side) large.fail("gap", "beyond the block");
            gap += rest;
        }
        if (count == escape) {
            const std::uint64_t rest = large.get_varint("count");
            if (rest > 0xffffffffu - escape) large.fail("count", "above 2^32");
            count += rest;
        }
        column += gap;
        if (column >= columns || k == pairs) large.fail("symbols", "a pair lies beyond the block");
        block.column[k] = static_cast<std::uint16_t>(column++);
        block.count[k++] = static_cast<std::uint32_t>(count);
        before = class_of[nibble];
    }
    if (k != pairs) large.fail("symbols", "not as many as pairs");
    for (std::size_t c = 0; c < class_count; ++c)
        if (streams.next[c] != streams.end[c]) large.fail("symbols", "bytes left over");
    large.expect_end("large values");
    return block;
}

}  // namespace luxel
