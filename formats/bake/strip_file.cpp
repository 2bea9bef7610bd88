#include "formats/bake/strip_file.h"

#include <bit>

#include "formats/bake/gap_symbols.h"
#include "formats/base/compress.h"

namespace luxel {
namespace {

constexpr std::uint64_t max_side = 65536;
constexpr std::size_t small_block_pairs = 1024;
/// Bits of all places with both levels above them, and five bytes of count for each place.
constexpr std::uint64_t most_index_bytes = max_side * max_side / 8 * 5 / 4 + 5 * max_side * max_side;

/// One level of the index above `words`: a bit per word that is not zero, and only those words are kept.
std::vector<std::uint64_t> occupied(std::span<const std::uint64_t> words) {
    std::vector<std::uint64_t> bits((words.size() + 63) / 64);
    for (std::size_t k = 0; k < words.size(); ++k)
        if (words[k]) bits[k / 64] |= std::uint64_t{1} << (k % 64);
    return bits;
}

void put_occupied(ByteWriter& out, std::span<const std::uint64_t> words) {
    std::vector<std::uint64_t> kept;
    for (const std::uint64_t word : words)
        if (word) kept.push_back(word);
    out.put_array(std::span<const std::uint64_t>(kept));
}

/// The inverse: `count` words, of which those with a bit in `bits` are read.
std::vector<std::uint64_t> get_occupied(ByteCursor& in, std::span<const std::uint64_t> bits, std::uint64_t count,
                                        const char* field) {
    std::uint64_t stored = 0;
    for (const std::uint64_t word : bits) stored += static_cast<std::uint64_t>(std::popcount(word));
    const auto kept = in.get_array<std::uint64_t>(stored, field);
    std::vector<std::uint64_t> words(count);
    std::size_t next = 0;
    for (std::size_t k = 0; k < bits.size(); ++k)
        for (std::uint64_t word = bits[k]; word; word &= word - 1) {
            const std::size_t at = k * 64 + static_cast<std::size_t>(std::countr_zero(word));
            if (at >= count) in.fail(field, "a bit lies beyond the block");
            if (kept[next] == 0) in.fail(field, "an empty word is stored");
            words[at] = kept[next++];
        }
    return words;
}

[[noreturn]] void damaged(const BlockFileReader& file, const std::string& what) {
    throw Error(ErrorCode::damaged_store, file.name(), what, "remove the file and run the same command again");
}

/// The blocks before the pairs are there and in their places.
void check_fixed_blocks(const BlockFileReader& file) {
    if (file.blocks().size() < first_pair_block) damaged(file, "fewer blocks than a strip has");
    for (std::size_t k = 0; k < first_pair_block; ++k)
        if (file.blocks()[k].tag != k)
            damaged(file, "block " + std::to_string(k) + " has the tag " + std::to_string(file.blocks()[k].tag));
}

}  // namespace

Bytes encode_counts(const StripPairs& block) {
    const std::size_t words_per_row = (block.columns + 63) / 64;
    std::vector<std::uint64_t> pairs(block.rows * words_per_row);
    for (std::uint32_t row = 0; row < block.rows; ++row)
        for (std::uint32_t k = block.row_begin[row]; k < block.row_begin[row + 1]; ++k)
            pairs[row * words_per_row + block.column[k] / 64] |= std::uint64_t{1} << (block.column[k] % 64);
    const std::vector<std::uint64_t> word_bits = occupied(pairs);
    const std::vector<std::uint64_t> top_bits = occupied(word_bits);
    ByteWriter out;
    out.put_varint(block.rows);
    out.put_varint(block.columns);
    out.put_varint(block.column.size());
    out.put_array(std::span<const std::uint64_t>(top_bits));
    put_occupied(out, word_bits);
    put_occupied(out, pairs);
    for (const std::uint32_t count : block.count) out.put_varint(count);
    return out.take();
}

StripPairs decode_counts(ByteView raw, bool diagonal, const std::string& where) {
    ByteCursor in(raw, where);
    StripPairs block;
    const std::uint64_t rows = in.get_varint("rows"), columns = in.get_varint("columns");
    const std::uint64_t pair_count = in.get_varint("pair count");
    if (rows == 0 || rows > max_side || columns == 0 || columns > max_side) in.fail("size", "not in 1 .. 65536");
    if (pair_count == 0 || pair_count > rows * columns || pair_count > 0xffffffffu)
        in.fail("pair count", "zero or more than the block holds");
    block.rows = static_cast<std::uint32_t>(rows);
    block.columns = static_cast<std::uint32_t>(columns);
    const std::uint64_t words_per_row = (columns + 63) / 64, words = rows * words_per_row;
    const std::uint64_t bit_words = (words + 63) / 64;
    const auto top_bits = in.get_array<std::uint64_t>((bit_words + 63) / 64, "top bits");
    const auto word_bits = get_occupied(in, top_bits, bit_words, "word bits");
    const auto pairs = get_occupied(in, word_bits, words, "pair bits");

    if (pair_count > in.remaining()) in.fail("counts", "file ends here");
    block.row_begin.resize(rows + 1);
    block.column.resize(pair_count);
    block.count.resize(pair_count);
    std::uint64_t next = 0;
    for (std::uint64_t row = 0; row < rows; ++row) {
        block.row_begin[row] = static_cast<std::uint32_t>(next);
        for (std::uint64_t w = 0; w < words_per_row; ++w)
            for (std::uint64_t word = pairs[row * words_per_row + w]; word; word &= word - 1) {
                const std::uint64_t column = w * 64 + static_cast<std::uint64_t>(std::countr_zero(word));
                if (column >= columns || (diagonal && column <= row) || next == pair_count)
                    in.fail("pair bits", "a bit lies beyond the block");
                block.column[next++] = static_cast<std::uint16_t>(column);
            }
    }
    block.row_begin[rows] = static_cast<std::uint32_t>(next);
    if (next != pair_count) in.fail("pair bits", "not as many bits as pairs");
    for (std::uint32_t& count : block.count) {
        const std::uint64_t value = in.get_varint("count");
        if (value == 0 || value > 0xffffffffu) in.fail("count", "zero or above 2^32");
        count = static_cast<std::uint32_t>(value);
    }
    in.expect_end("strip block");
    return block;
}

BlockFileWriter::Packed pack_pairs(const StripPairs& block) {
    const Bytes gaps = encode_gaps(block);
    // An index wins in small blocks, where the codes of symbols weigh, and in regular ones, where symbols need hardly more
    // than the one bit that a code has at least; elsewhere it is not worth its time.
    const bool try_index = block.column.size() < small_block_pairs || gaps.size() < block.column.size() / 4;
    Bytes frame;
    ByteWriter size;
    if (try_index) {
        const Bytes index = encode_counts(block);
        size.put_varint(index.size());
        frame = compress(index, 3);
    }
    const bool smaller = try_index && size.size() + frame.size() < gaps.size();
    ByteWriter out;
    out.put(static_cast<std::uint8_t>(smaller ? PairCodec::bit_index : PairCodec::gap_symbols));
    if (smaller) out.put_array(std::span<const std::uint8_t>(size.bytes()));
    out.put_array(std::span<const std::uint8_t>(smaller ? frame : gaps));
    return BlockFileWriter::pack(out.bytes(), 0);
}

StripPairs unpack_pairs(ByteView bytes, bool diagonal, const std::string& where, StripPairs reuse) {
    ByteCursor in(bytes, where);
    const auto codec = in.get<std::uint8_t>("codec");
    if (codec == static_cast<std::uint8_t>(PairCodec::gap_symbols)) 
        return decode_gaps(bytes.subspan(1), diagonal, where, std::move(reuse));
    if (codec != static_cast<std::uint8_t>(PairCodec::bit_index)) in.fail("codec", "unknown: " + std::to_string(codec));
    const std::uint64_t raw_bytes = in.get_varint("index bytes");
    if (raw_bytes > most_index_bytes) in.fail("index bytes", "more than a block can have");
    return decode_counts(decompress(in.get_view(in.remaining(), "index"), raw_bytes, where), diagonal, where);
}

RayTallies read_tallies(const BlockFileReader& file) {
    check_fixed_blocks(file);
    return load_tallies(file);
}

std::vector<StripBlockInfo> read_strip_directory(const BlockFileReader& file) {
    check_fixed_blocks(file);
    const Bytes raw = file.read(4);
    ByteCursor in(raw, file.name() + ": directory");
    const auto count = in.get<std::uint64_t>("block count");
    if (file.blocks().size() != first_pair_block + count) in.fail("block count", "not the number of blocks in the file");
    std::vector<StripBlockInfo> directory;
    for (std::uint64_t k = 0; k < count; ++k) {
        StripBlockInfo info;
        info.b = in.get<std::uint32_t>("chunk b");
        info.pair_count = in.get<std::uint64_t>("pair count");
        if (!directory.empty() && info.b <= directory.back().b) in.fail("chunk b", "not ascending");
        if (info.pair_count == 0) in.fail("pair count", "a block without pairs");
        if (file.blocks()[first_pair_block + k].tag != first_pair_block + info.b)
            in.fail("chunk b", "the block has another tag");
        directory.push_back(info);
    }
    in.expect_end("directory");
    return directory;
}

StripWriter::StripWriter(const std::filesystem::path& path, const Key& key, RayTallies tallies)
    : path_(path), key_(key), tallies_(std::move(tallies)) {}

void StripWriter::append(std::uint32_t b, std::uint64_t pair_count, const BlockFileWriter::Packed& block) {
    directory_.push_back({b, pair_count});
    blocks_.push_back(block);
}

BlockFileWriter StripWriter::whole_file() const {
    BlockFileWriter file(path_, FileKind::strip, strip_version, key_);
    append_tallies(file, tallies_);
    ByteWriter directory;
    directory.put(static_cast<std::uint64_t>(directory_.size()));
    for (const StripBlockInfo& info : directory_) directory.put(info.b), directory.put(info.pair_count);
    file.append(4, directory.bytes());
    for (std::size_t k = 0; k < blocks_.size(); ++k)
        file.append_packed(first_pair_block + directory_[k].b, blocks_[k]);
    return file;
}

void StripWriter::publish() { whole_file().publish(); }

void StripWriter::publish(Publisher& publisher) { whole_file().publish(publisher); }

}  // namespace luxel
