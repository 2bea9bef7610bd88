/// Any bytes as a pair block of a strip. The first byte: bit 0, a block of the diagonal; bits 1 and 2, what is decoded: the block
/// with its codec, a bit index without its frame, or gap symbols whose numbers are in the clear (two bytes of size before
/// each part) and get their frames here. Refused as a damaged store, or pairs that both codecs give back.
#include <algorithm>
#include <array>
#include <cstddef>

#include "formats/bake/gap_symbols.h"
#include "formats/base/compress.h"
#include "tests/fuzz/fuzz_file.h"

namespace luxel {
namespace {

void check(const StripPairs& block, bool diagonal) {
    fuzz::require(block.rows > 0 && block.rows <= 65536 && block.columns > 0 && block.columns <= 65536);
    fuzz::require(block.row_begin.size() == block.rows + 1u && block.row_begin.front() == 0);
    fuzz::require(block.row_begin.back() == block.column.size() && block.column.size() == block.count.size());
    for (std::uint32_t row = 0; row < block.rows; ++row) {
        fuzz::require(block.row_begin[row] <= block.row_begin[row + 1]);
        for (std::uint32_t k = block.row_begin[row]; k < block.row_begin[row + 1]; ++k) {
            fuzz::require(block.column[k] < block.columns && block.count[k] > 0 && (!diagonal || block.column[k] > row));
            fuzz::require(k == block.row_begin[row] || block.column[k - 1] < block.column[k]);
        }
    }
}

bool equal(const StripPairs& a, const StripPairs& b) {
    return a.rows == b.rows && a.columns == b.columns && a.row_begin == b.row_begin && a.column == b.column && a.count == b.count;
}

/// Rows, columns and pairs of two bytes each, classes and symbols as they are, then row sizes and large values: first bytes, which
/// get a frame, and rests.
Bytes framed_gaps(ByteView input) {
    const auto number = [&] {
        const std::size_t value = input.size() < 2 ? 0 : input[0] | std::size_t{input[1]} << 8;
        input = input.subspan(std::min<std::size_t>(2, input.size()));
        return value;
    };
    ByteWriter out;
    for (int k = 0; k < 3; ++k) out.put_varint(number());
    const auto part = [&] {
        const std::size_t size = number();
        const ByteView found = input.first(std::min(size, input.size()));
        input = input.subspan(found.size());
        return found;
    };
    out.put_array(part());
    for (int k = 0; k < 2; ++k) {
        const ByteView first = part(), rest = part();
        if (first.empty()) continue;
        const Bytes frame = compress_literals(first);
        out.put_varint(frame.size());
        out.put_array(std::span<const std::uint8_t>(frame));
        out.put_array(rest);
    }
    return out.take();
}

StripPairs decode(unsigned how, ByteView input, bool diagonal) {
    if (how == 0) return unpack_pairs(input, diagonal, "fuzz");
    if (how == 1) return decode_counts(input, diagonal, "fuzz");
    return decode_gaps(framed_gaps(input), diagonal, "fuzz");
}

}  // namespace
}  // namespace luxel

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace luxel;
    if (size == 0) return 0;
    const bool diagonal = data[0] & 1;
    const unsigned how = data[0] >> 1 & 3;
    StripPairs block;
    if (!fuzz::accepts([&] { block = decode(how, {data + 1, size - 1}, diagonal); })) return 0;
    check(block, diagonal);
    fuzz::require(equal(unpack_pairs(pack_pairs(block).stored, diagonal, "again"), block));
    fuzz::require(equal(decode_counts(encode_counts(block), diagonal, "again"), block));
    fuzz::require(equal(decode_gaps(encode_gaps(block), diagonal, "again"), block));
    return 0;
}
