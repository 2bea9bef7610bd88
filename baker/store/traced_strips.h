/// A matrix whose blocks are not all kept: the others are traced again when they are read, and are the same numbers.
///
/// The directory (which blocks there are, how large) is found once, block by block, without keeping any. Of the blocks some
/// may be kept in strip files: those that take most time to trace for each byte that they take on the disk. Time is rays: a
/// block (a, b) wants the rays of both chunks, so the small blocks between chunks that see little of each other, which are
/// most of the blocks and few of the bytes, are the first to be worth their place; a chunk's own block is among the last.
#pragma once
#include "baker/core/progress.h"
#include "baker/store/strip_store.h"
#include "baker/store/traced_rows.h"
#include "formats/bake/directory_file.h"

namespace luxel {

/// Traces and pools every block once, in order. Progress: strips. Threads: uses them all.
StripDirectory find_directory(TracedRows& rows, const ProgressFunction& progress);

/// The blocks to keep within `budget_bytes`, as flags per block of the directory: most rays per stored byte first; a block that does
/// not fit is passed over. Pure.
std::vector<bool> blocks_to_keep(const StripDirectory& directory, const TracedRows& rows, std::uint64_t budget_bytes);

/// Publishes one strip file per chunk with the wanted blocks and the tallies, where it is not there yet, under key `hot`.
void keep_blocks(TracedRows& rows, const StripDirectory& directory, const std::vector<bool>& keep,
                 const std::filesystem::path& folder, const Key& hot, const ProgressFunction& progress);

class TracedStrips final : public MatrixStore {
  public:
    /// `rows` must outlive it. `kept`: the strips with the kept blocks, or null. `file_bytes`: of the directory on disk.
    /// Throws Error{damaged_store} when directory or kept blocks do not fit the chunks or each other.
    TracedStrips(TracedRows& rows, StripDirectory directory, std::unique_ptr<StripStore> kept, std::uint64_t file_bytes);

    [[nodiscard]] const ChunkLayout& layout() const override { return rows_.layout(); }
    [[nodiscard]] std::size_t block_count() const override { return blocks_.size(); }
    /// Threads: reentrant. Throws Error{damaged_store} when a traced block is not the one of the directory.
    void load(std::size_t index, CountBlock& out) const override;
    [[nodiscard]] std::span<const BlockInfo> blocks() const override { return blocks_; }
    [[nodiscard]] const RayTallies& tallies() const override { return tallies_; }
    [[nodiscard]] std::uint64_t file_bytes() const override { return file_bytes_ + (kept_ ? kept_->file_bytes() : 0); }

  private:
    TracedRows& rows_;
    RayTallies tallies_;
    std::vector<BlockInfo> blocks_;
    std::unique_ptr<StripStore> kept_;
    std::vector<std::size_t> kept_index_;  ///< per block: its number in kept_, or not_kept
    std::uint64_t file_bytes_;
};

}  // namespace luxel
