/// A BlockSource that holds all blocks in memory: for tests and for scenes small enough not to need a store.
///
/// Loads count as if the blocks were stored with 8 bytes a pair, in whole 4096-byte pages. Owns everything it is given.
/// Threads: load() is reentrant. Errors: Error{internal} for pairs out of range, doubled, on the diagonal or not
/// positive.
#pragma once
#include <atomic>
#include <cstdint>
#include <span>
#include <vector>

#include "baker/formfactors/block_source.h"

namespace luxel {

/// One entry of the symmetric matrix; order of i and j does not matter, i != j.
struct ExchangePair {
    PatchNumber i = 0, j = 0;
    float area_m2 = 0;  ///< G_ij > 0
};

class MemoryBlocks final : public BlockSource {
  public:
    /// `pairs` in any order, each unordered pair at most once. area_m2 and diagonal_m2 have layout.patch_count()
    /// entries.
    MemoryBlocks(ChunkLayout layout, std::vector<double> area_m2, std::vector<double> diagonal_m2,
                 std::vector<ExchangePair> pairs);

    [[nodiscard]] const ChunkLayout& layout() const override { return layout_; }
    [[nodiscard]] std::span<const double> area_m2() const override { return area_m2_; }
    [[nodiscard]] std::span<const double> diagonal_m2() const override { return diagonal_m2_; }
    [[nodiscard]] std::span<const BlockInfo> blocks() const override { return infos_; }
    void load(std::size_t index, Block& out) override;
    [[nodiscard]] std::shared_ptr<const Block> share(std::size_t index) override;
    [[nodiscard]] std::uint64_t bytes_read() const override { return bytes_read_.load(); }

  private:
    ChunkLayout layout_;
    std::vector<double> area_m2_, diagonal_m2_;
    std::vector<BlockInfo> infos_;
    std::vector<Block> blocks_;
    std::atomic<std::uint64_t> bytes_read_{0};
};

}  // namespace luxel
