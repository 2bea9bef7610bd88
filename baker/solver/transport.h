/// The equation as the solvers use it: the self-exchange of each patch eliminated, rows found by chunk, reads counted.
///
/// From B_i = M_i + rho_i/A_i (G_ii B_i + sum_{j != i} G_ij B_j) follows, with D_i = 1 - rho_i G_ii / A_i,
///     B = M' + K B,   M' = M / D,   rho' = rho / D,   K_ij = rho'_i G_ij / A_i  (i != j),   K >= 0.
/// So the diagonal is exact and free, and its tiny negative values (the remainder of closure) leave a nonnegative
/// system. Units: areas and G in m2, rho' without unit (may exceed 1 where a patch sees itself). Ownership: keeps
/// references to the source and the reflectances. Threads: load() is reentrant, forget() is not.
#pragma once
#include <array>
#include <atomic>
#include <cstdint>
#include <span>
#include <vector>

#include "baker/formfactors/block_apply.h"
#include "baker/formfactors/block_source.h"
#include "baker/solver/solver.h"

namespace luxel {

/// A block of the row of one chunk, other than its diagonal block.
struct RowBlock {
    std::size_t index = 0;  ///< in BlockSource::blocks()
    ChunkNumber other = 0;
    bool is_a = true;  ///< the row's chunk is block.a, the other one block.b
};

class Transport {
  public:
    /// Channels without any emission are switched off (rho' = 0 there): no light, nothing to bound.
    Transport(BlockSource& source, std::span<const Rgb> reflectance, const std::array<bool, 3>& channel_is_lit);

    [[nodiscard]] const ChunkLayout& layout() const { return source_.layout(); }
    [[nodiscard]] PatchNumber first(ChunkNumber chunk) const { return source_.layout().first_patch[chunk]; }
    [[nodiscard]] std::uint32_t size(ChunkNumber chunk) const { return source_.layout().size(chunk); }
    [[nodiscard]] double area_m2(PatchNumber patch) const { return source_.area_m2()[patch]; }
    [[nodiscard]] double diagonal_m2(PatchNumber patch) const { return source_.diagonal_m2()[patch]; }
    [[nodiscard]] double reflectance(PatchNumber patch, std::size_t channel) const;  ///< rho
    [[nodiscard]] double self_factor(PatchNumber patch, std::size_t channel) const;  ///< D, at least 1e-12
    [[nodiscard]] const Channels& scaled_reflectance(PatchNumber patch) const { return scaled_[patch]; }  ///< rho'
    /// rho' = 0 in all channels: for patches that no light can reach. Changes no radiosity.
    void forget(PatchNumber patch) {
        scaled_[patch] = {0, 0, 0};
        forgotten_.push_back(patch);
    }
    /// In the order in which they were forgotten; some more than once.
    [[nodiscard]] std::span<const PatchNumber> forgotten() const { return forgotten_; }

    [[nodiscard]] std::span<const BlockInfo> blocks() const { return source_.blocks(); }
    [[nodiscard]] std::span<const RowBlock> row(ChunkNumber chunk) const { return rows_[chunk]; }
    [[nodiscard]] bool has_diagonal(ChunkNumber chunk) const { return diagonal_[chunk] != no_block; }
    [[nodiscard]] std::uint64_t diagonal_bytes(ChunkNumber chunk) const {
        return blocks()[diagonal_[chunk]].read_bytes;
    }
    /// Bytes of all blocks of the row, the diagonal block included.
    [[nodiscard]] std::uint64_t row_bytes(ChunkNumber chunk) const { return row_bytes_[chunk]; }

    [[nodiscard]] std::shared_ptr<const Block> load(std::size_t block_index);
    /// Null where the chunk has no pairs of its own.
    [[nodiscard]] std::shared_ptr<const Block> load_diagonal(ChunkNumber chunk);
    /// The blocks of the row, but for the diagonal one, will be loaded soon.
    void expect_row(ChunkNumber chunk);
    /// Bytes asked for so far, whether they came from the disk or from a cache: decisions depend on this count only.
    [[nodiscard]] std::uint64_t requested_bytes() const { return requested_bytes_.load(); }
    /// Counts from here: a solve goes on that had asked for so many.
    void resume_at(std::uint64_t requested_bytes) { requested_bytes_ = requested_bytes; }

  private:
    static constexpr std::size_t no_block = static_cast<std::size_t>(-1);
    BlockSource& source_;
    std::span<const Rgb> reflectance_;
    std::vector<Channels> scaled_;
    std::vector<PatchNumber> forgotten_;
    std::vector<std::vector<RowBlock>> rows_;
    std::vector<std::size_t> diagonal_;
    std::vector<std::uint64_t> row_bytes_;
    std::atomic<std::uint64_t> requested_bytes_{0};
};

/// Blocks whose contributions are held in memory at the same time before they are added in block order. Fixed, so that
/// results do not depend on threads.
constexpr std::size_t transport_batch_blocks = 16;

}  // namespace luxel
