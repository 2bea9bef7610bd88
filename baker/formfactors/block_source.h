/// The contract between the store and the solvers; neither knows the other. Final.
///
/// The matrix of exchange areas G (m2, symmetric) is cut into blocks (a, b) of chunks a <= b; only those are held. A block
/// is applied both ways: rows of a gather from b, and rows of b gather from a. Pairs of one chunk (a == b) appear once,
/// with row < column; the diagonal is a vector of its own. Row i of G sums to area_m2[i] minus what left into the open.
#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "baker/patches/patch.h"

namespace luxel {

using ChunkNumber = std::uint32_t;

/// Consecutive patch numbers of each chunk: chunk c holds [first_patch[c], first_patch[c + 1]).
struct ChunkLayout {
    std::vector<PatchNumber> first_patch{0};
    /// A chunk holds at most this many patches: columns of a block are 16 bits.
    static constexpr std::uint32_t max_chunk_patches = 65536;

    [[nodiscard]] ChunkNumber chunk_count() const { return static_cast<ChunkNumber>(first_patch.size() - 1); }
    [[nodiscard]] std::uint32_t patch_count() const { return first_patch.back(); }
    [[nodiscard]] std::uint32_t size(ChunkNumber chunk) const { return first_patch[chunk + 1] - first_patch[chunk]; }
    [[nodiscard]] ChunkNumber chunk_of(PatchNumber patch) const;  ///< binary search
};

struct BlockInfo {
    ChunkNumber a = 0, b = 0;     ///< a <= b
    std::uint64_t pair_count = 0;  ///< > 0: empty blocks do not exist
    std::uint64_t read_bytes = 0;  ///< what one load() costs, in whole 4096-byte pages
};

/// A decoded block: compressed rows. Pair k of row r: columns[k], areas_m2[k] for k in [row_begin[r], row_begin[r + 1]).
struct Block {
    ChunkNumber a = 0, b = 0;
    std::vector<std::uint32_t> row_begin;  ///< size(a) + 1
    std::vector<std::uint16_t> columns;    ///< patch number minus first_patch[b], ascending in a row; > row when a == b
    std::vector<float> areas_m2;           ///< G_ij > 0
};

class BlockSource {
  public:
    virtual ~BlockSource() = default;
    [[nodiscard]] virtual const ChunkLayout& layout() const = 0;
    /// Per patch, m2; A_i > 0.
    [[nodiscard]] virtual std::span<const double> area_m2() const = 0;
    /// G_ii per patch, m2. Tiny negative values are possible: the remainder of closure.
    [[nodiscard]] virtual std::span<const double> diagonal_m2() const = 0;
    /// All blocks, sorted by (a, b).
    [[nodiscard]] virtual std::span<const BlockInfo> blocks() const = 0;
    /// Decodes block `index` of blocks(). Threads: reentrant. Throws Error{damaged_store}. Adds to bytes_read().
    virtual void load(std::size_t index, Block& out) = 0;
    /// The same, without a copy where the block is in memory already. Never null.
    [[nodiscard]] virtual std::shared_ptr<const Block> share(std::size_t index) {
        auto block = std::make_shared<Block>();
        load(index, *block);
        return block;
    }
    /// These blocks will be asked for soon, in this order: a source may begin to read them. Changes nothing that load() gives.
    virtual void expect(std::span<const std::size_t>) {}
    /// Sum of read_bytes over all loads so far that went to the disk.
    [[nodiscard]] virtual std::uint64_t bytes_read() const = 0;
    /// Sum of read_bytes over all blocks: one full read.
    [[nodiscard]] std::uint64_t total_bytes() const {
        std::uint64_t sum = 0;
        for (const BlockInfo& block : blocks()) sum += block.read_bytes;
        return sum;
    }
};

}  // namespace luxel
