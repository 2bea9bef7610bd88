/// The pooled counts of a scene as closure, solver and light read them, wherever they come from: strips on disk
/// (strip_store.h), or rays that are traced again (traced_strips.h). The same scene gives the same numbers from each.
#pragma once
#include <span>
#include <utility>

#include "baker/formfactors/closure.h"
#include "formats/bake/strip_file.h"

namespace luxel {

/// Blocks are numbered in the order of (a, b).
class MatrixStore : public CountSource {
  public:
    /// One entry per block. read_bytes is what a read of the block's strip would cost (strip_read_bytes), also where no strip
    /// is kept: a solver that weighs its reads does the same with and without files.
    [[nodiscard]] virtual std::span<const BlockInfo> blocks() const = 0;
    /// Per patch of all chunks.
    [[nodiscard]] virtual const RayTallies& tallies() const = 0;
    /// Bytes on disk.
    [[nodiscard]] virtual std::uint64_t file_bytes() const = 0;
    [[nodiscard]] std::uint64_t pair_count() const {
        std::uint64_t sum = 0;
        for (const BlockInfo& block : blocks()) sum += block.pair_count;
        return sum;
    }
};

/// A stored block with its trailer, in whole 4096-byte pages.
constexpr std::uint64_t strip_read_bytes(std::uint64_t stored_bytes) {
    constexpr std::uint64_t page_bytes = 4096, trailer_bytes = 16;
    return (stored_bytes + trailer_bytes + page_bytes - 1) / page_bytes * page_bytes;
}

/// Makes `out` the block `info` with these pairs.
inline void set_pairs(const BlockInfo& info, StripPairs&& pairs, CountBlock& out) {
    out = {info.a, info.b, std::move(pairs.row_begin), std::move(pairs.column), std::move(pairs.count)};
}

}  // namespace luxel
