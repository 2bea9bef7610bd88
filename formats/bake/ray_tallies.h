/// What became of the rays of patches, in total: the columns with which strips and directories begin (strip_file.md,
/// directory_file.md). Threads: pure functions.
#pragma once
#include <cstdint>
#include <vector>

#include "formats/base/block_file.h"

namespace luxel {

/// Rays, one entry per patch in each column; self + open + back <= rays.
struct RayTallies {
    std::vector<std::uint32_t> rays;  ///< N_i: rays that the patch has sent
    std::vector<std::uint32_t> self;  ///< n_ii: of those, landed on the patch itself
    std::vector<std::uint32_t> open;  ///< left into the open
    std::vector<std::uint32_t> back;  ///< absorbed by the back of a one-sided surface

    /// Those of further patches, behind the others.
    void append(const RayTallies& further);
    /// Those of patches [begin, end).
    [[nodiscard]] RayTallies part(std::size_t begin, std::size_t end) const;
};

/// Blocks 0 to 3 of a file.
void append_tallies(BlockFileWriter& file, const RayTallies& tallies);
/// Throws Error{damaged_store}: columns of different lengths, more rays ended than sent.
RayTallies load_tallies(const BlockFileReader& file);

}  // namespace luxel
