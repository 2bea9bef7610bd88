/// Pooled counts on disk: one strip file per chunk a, a block for every chunk b >= a with pairs. strip_file.md.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "formats/bake/ray_tallies.h"

namespace luxel {

constexpr std::uint32_t strip_version = 3;

/// Counts of the pairs of a block in compressed rows: row r holds pairs [row_begin[r], row_begin[r + 1]).
struct StripPairs {
    std::uint32_t rows = 0, columns = 0;   ///< patches of chunk a and b; at most 65536
    std::vector<std::uint32_t> row_begin;  ///< rows + 1
    std::vector<std::uint16_t> column;     ///< ascending in a row
    std::vector<std::uint32_t> count;      ///< > 0
};

/// How a pair block is written; its first byte.
enum class PairCodec : std::uint8_t {
    bit_index = 1,    ///< hierarchical bit index and counts, in one zstd frame
    gap_symbols = 2,  ///< gap_symbols.h
};

/// A pair block as it is stored: by the codec that makes it smaller, as far as that can be expected without trying.
/// Pure. Requires a valid block.
BlockFileWriter::Packed pack_pairs(const StripPairs& block);

/// The inverse, for the block's decoded bytes. Validates everything. `diagonal`: only columns above the row are legal. Throws
/// Error{damaged_store} naming `where`. `reuse`: its memory serves again.
StripPairs unpack_pairs(ByteView bytes, bool diagonal, const std::string& where, StripPairs reuse = {});

/// Codec bit_index without its frame: hierarchical bit index, then counts. Pure. Requires a valid block (ascending columns, counts > 0).
Bytes encode_counts(const StripPairs& block);

/// Validates everything. `diagonal`: only columns above the row are legal. Throws Error{damaged_store} naming `where`.
StripPairs decode_counts(ByteView raw, bool diagonal, const std::string& where);

struct StripBlockInfo {
    std::uint32_t b = 0;
    std::uint64_t pair_count = 0;
};

/// Reads the fixed first blocks of a strip: tallies and directory; block k of the directory is block k + 5 of the file.
RayTallies read_tallies(const BlockFileReader& file);
std::vector<StripBlockInfo> read_strip_directory(const BlockFileReader& file);
constexpr std::size_t first_pair_block = 5;

/// Collects the blocks of one strip and publishes the file whole. Blocks must come in ascending order of b.
class StripWriter {
  public:
    StripWriter(const std::filesystem::path& path, const Key& key, RayTallies tallies);
    void append(std::uint32_t b, std::uint64_t pair_count, const BlockFileWriter::Packed& block);
    void publish();
    void publish(Publisher& publisher);

  private:
    [[nodiscard]] BlockFileWriter whole_file() const;
    std::filesystem::path path_;
    Key key_;
    RayTallies tallies_;
    std::vector<StripBlockInfo> directory_;
    std::vector<BlockFileWriter::Packed> blocks_;
};

}  // namespace luxel
