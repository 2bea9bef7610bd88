/// What the rays of a chunk met, traced when it is asked for: the half of a block that one of its chunks finds. A pure
/// function of geometry, stable ids, levels and the estimator's options, so nothing of it needs a place on the disk.
#pragma once
#include <atomic>
#include <condition_variable>
#include <exception>
#include <memory>
#include <mutex>
#include <vector>

#include "baker/formfactors/estimator.h"
#include "baker/formfactors/level_plan.h"
#include "baker/store/matrix_store.h"

namespace luxel {

/// The rays of one chunk, counted and packed as strips are: by runs of neighbouring rows and by the chunk that was met.
struct TracedChunk {
    /// Rows first_row .. of the chunk against one other chunk, or the chunk itself (then without what landed on its own patch).
    struct Segment {
        ChunkNumber target = 0;
        BlockFileWriter::Packed pairs;  ///< pack_pairs(..., false)
    };
    struct Run {
        std::uint32_t first_row = 0, rows = 0;
        std::vector<Segment> segments;  ///< ascending targets
    };
    StripTallies tallies;
    std::vector<Run> runs;
    std::uint64_t bytes = 0;  ///< resident
};

/// Keeps the rows of as many chunks as fit the limit. When they do not all fit, the one that was used last makes room: readers
/// go through all chunks again and again, so it is the one that will be needed latest. What is kept changes only what is
/// traced again, never a result.
/// Threads: chunk() is reentrant, also from inside parallel loops; whoever has to wait for a trace takes part in it.
/// Memory: limit_bytes, one chunk for each thread beyond it, and 128 rows per thread while they are traced.
class TracedRows {
  public:
    /// Keeps references to `estimator` and `layout`, which must outlive it. `levels`: all that each patch has sent.
    TracedRows(const Estimator& estimator, const ChunkLayout& layout, LevelPlan levels, std::uint64_t limit_bytes);

    [[nodiscard]] const ChunkLayout& layout() const { return layout_; }
    [[nodiscard]] std::uint64_t limit_bytes() const { return limit_bytes_; }
    /// Throws Error{damaged_store} when a patch or pair has 2^32 rays or more.
    std::shared_ptr<const TracedChunk> chunk(ChunkNumber c);
    /// Rays of all chunks: what one whole trace takes. And of one chunk.
    [[nodiscard]] std::uint64_t rays_of_all() const;
    [[nodiscard]] std::uint64_t rays_of(ChunkNumber c) const;
    /// Traced so far, as often as they were.
    [[nodiscard]] std::uint64_t rays_traced() const { return rays_traced_; }
    [[nodiscard]] std::uint64_t held_bytes() const;
    /// Gives all kept rows back.
    void forget();

  private:
    struct Job;
    struct Slot {
        std::shared_ptr<const TracedChunk> rows;
        std::uint64_t used = 0;  ///< time of the last use
    };
    void keep(ChunkNumber c, std::shared_ptr<const TracedChunk> rows);
    std::shared_ptr<const TracedChunk> trace(ChunkNumber c, std::unique_lock<std::mutex>& lock);

    const Estimator& estimator_;
    const ChunkLayout& layout_;
    LevelPlan levels_;
    std::uint64_t limit_bytes_, held_bytes_ = 0, time_ = 0;
    std::atomic<std::uint64_t> rays_traced_{0};
    mutable std::mutex mutex_;
    std::condition_variable finished_;
    std::vector<Slot> slots_;   ///< per chunk
    std::shared_ptr<Job> job_;  ///< the one trace that is running
};

/// All that `rows` of chunk `from` met in chunk `to`. `column` is empty where there is nothing. Pure.
StripPairs rays_between(const TracedChunk& rows, const ChunkLayout& layout, ChunkNumber from, ChunkNumber to);

/// Block (a, b), a <= b, as pooling makes it from the same rays: what a saw of b and b of a. `column` is empty where the
/// block does not exist. Pure.
StripPairs pooled_block(const TracedChunk& rows_a, const TracedChunk& rows_b, const ChunkLayout& layout, ChunkNumber a,
                        ChunkNumber b);

}  // namespace luxel
