/// The strips of a scene as the solvers and the closure read them.
#pragma once
#include <atomic>
#include <filesystem>
#include <list>
#include <memory>
#include <mutex>
#include <vector>

#include "baker/formfactors/closure.h"
#include "formats/bake/strip_file.h"

namespace luxel {

/// Opens all strips of a folder; keeps their directories and at most `max_open_files` of them open.
/// Throws Error{damaged_store}: a strip is missing or damaged, or does not fit the layout.
class StripStore final : public CountSource {
  public:
    StripStore(std::filesystem::path folder, const Key& key, const ChunkLayout& layout);

    [[nodiscard]] const ChunkLayout& layout() const override { return layout_; }
    [[nodiscard]] std::size_t block_count() const override { return blocks_.size(); }
    /// Blocks are numbered in the order of (a, b). Threads: reentrant.
    void load(std::size_t index, CountBlock& out) const override;

    /// One entry per block; read_bytes: stored bytes with trailer in whole 4096-byte pages.
    [[nodiscard]] std::span<const BlockInfo> blocks() const { return blocks_; }
    /// Per patch of all chunks.
    [[nodiscard]] const StripTallies& tallies() const { return tallies_; }
    [[nodiscard]] std::uint64_t file_bytes() const { return file_bytes_; }
    [[nodiscard]] std::uint64_t pair_count() const;

  private:
    [[nodiscard]] std::shared_ptr<const BlockFileReader> open_strip(ChunkNumber a) const;

    std::filesystem::path folder_;
    Key key_;
    ChunkLayout layout_;
    std::vector<BlockInfo> blocks_;
    std::vector<std::size_t> first_block_;  ///< per chunk a: index of its first block in blocks_
    StripTallies tallies_;
    std::uint64_t file_bytes_ = 0;
    mutable std::mutex mutex_;
    /// Most recently used first.
    mutable std::list<std::pair<ChunkNumber, std::shared_ptr<const BlockFileReader>>> open_;
};

/// Strips and closure together: the matrix of exchange areas.
class ClosedStrips final : public BlockSource {
  public:
    /// References must outlive it.
    ClosedStrips(const StripStore& strips, std::span<const double> area_m2, const Closure& closure)
        : strips_(strips), area_m2_(area_m2), closure_(closure) {}
    [[nodiscard]] const ChunkLayout& layout() const override { return strips_.layout(); }
    [[nodiscard]] std::span<const double> area_m2() const override { return area_m2_; }
    [[nodiscard]] std::span<const double> diagonal_m2() const override { return closure_.diagonal_m2; }
    [[nodiscard]] std::span<const BlockInfo> blocks() const override { return strips_.blocks(); }
    void load(std::size_t index, Block& out) override;
    [[nodiscard]] std::uint64_t bytes_read() const override { return bytes_read_; }

  private:
    const StripStore& strips_;
    std::span<const double> area_m2_;
    const Closure& closure_;
    std::atomic<std::uint64_t> bytes_read_{0};
};

}  // namespace luxel
