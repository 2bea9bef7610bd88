/// The strips of a scene as the solvers and the closure read them.
#pragma once
#include <filesystem>
#include <list>
#include <memory>
#include <mutex>
#include <vector>

#include "baker/store/matrix_store.h"

namespace luxel {

/// Opens all strips of a folder; keeps their directories and at most `max_open_files` of them open.
/// Throws Error{damaged_store}: a strip is missing or damaged, or does not fit the layout.
class StripStore final : public MatrixStore {
  public:
    StripStore(std::filesystem::path folder, const Key& key, const ChunkLayout& layout);

    [[nodiscard]] const ChunkLayout& layout() const override { return layout_; }
    [[nodiscard]] std::size_t block_count() const override { return blocks_.size(); }
    /// Blocks are numbered in the order of (a, b). Threads: reentrant.
    void load(std::size_t index, CountBlock& out) const override;

    [[nodiscard]] std::span<const BlockInfo> blocks() const override { return blocks_; }
    [[nodiscard]] const RayTallies& tallies() const override { return tallies_; }
    [[nodiscard]] std::uint64_t file_bytes() const override { return file_bytes_; }

  private:
    [[nodiscard]] std::shared_ptr<const BlockFileReader> open_strip(ChunkNumber a) const;

    std::filesystem::path folder_;
    Key key_;
    ChunkLayout layout_;
    std::vector<BlockInfo> blocks_;
    std::vector<std::size_t> first_block_;  ///< per chunk a: index of its first block in blocks_
    RayTallies tallies_;
    std::uint64_t file_bytes_ = 0;
    mutable std::mutex mutex_;
    /// Most recently used first.
    mutable std::list<std::pair<ChunkNumber, std::shared_ptr<const BlockFileReader>>> open_;
};

}  // namespace luxel
