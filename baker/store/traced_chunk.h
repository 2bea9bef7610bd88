/// What the rays of a chunk met, counted and packed as strips are, and the blocks that two chunks' rays make. Pure functions.
#pragma once
#include <memory>
#include <vector>

#include "baker/formfactors/estimator.h"
#include "baker/formfactors/level_plan.h"
#include "baker/store/matrix_store.h"

namespace luxel {

/// Rows [first_row, first_row + rows) of a chunk against another chunk, or itself (then without what landed on its own patch).
struct SideRun {
    std::uint32_t first_row = 0, rows = 0;
    BlockFileWriter::Packed pairs;  ///< pack_pairs()
};

/// All that the rays of one chunk met in another: half of a block. Runs by row; rows between them met nothing.
struct Side {
    std::vector<SideRun> runs;
    std::uint64_t bytes = 0;  ///< resident
};

/// The rays of one chunk.
struct TracedChunk {
    struct Target {
        ChunkNumber chunk = 0;
        std::shared_ptr<const Side> side;  ///< not null, not empty
    };
    RayTallies tallies;
    std::vector<Target> targets;  ///< ascending
    std::uint64_t bytes = 0;      ///< resident, sides and all

    /// Null if no ray met the chunk.
    [[nodiscard]] std::shared_ptr<const Side> side(ChunkNumber target) const;
};

/// Rows that are traced and packed together: few enough for a thread's memory, many enough to pack well.
constexpr std::uint32_t run_rows = 128;

/// One run of a chunk by the chunks that it met.
struct TracedRun {
    std::vector<std::pair<ChunkNumber, SideRun>> sides;  ///< ascending
};

/// Traces run `run` of chunk `chunk`; its tallies go to their places in `tallies` (sized for the chunk). Throws Error{damaged_store}
/// when a patch or a pair has 2^32 rays or more. Threads: reentrant for different runs of one `tallies`.
TracedRun trace_run(const Estimator& estimator, const ChunkLayout& layout, const LevelPlan& levels, ChunkNumber chunk,
                    std::uint32_t run, RayTallies& tallies);

/// All runs of a chunk, in order, put together.
TracedChunk traced_chunk(std::vector<TracedRun> runs, RayTallies tallies);

/// Block (a, b), a <= b, as pooling makes it from the same rays: what a saw of b and b of a; null sides saw nothing. For a == b both
/// are the same side. `column` is empty where the block does not exist.
StripPairs pooled_block(const Side* a_to_b, const Side* b_to_a, const ChunkLayout& layout, ChunkNumber a, ChunkNumber b);

}  // namespace luxel
