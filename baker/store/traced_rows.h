/// Blocks from rays that are traced when they are asked for. What a chunk's rays meet is a pure function of geometry, stable ids, levels
/// and the estimator's options, so nothing of it needs a place on the disk.
#pragma once
#include <atomic>
#include <condition_variable>
#include <list>
#include <map>
#include <mutex>
#include <optional>

#include "baker/store/traced_chunk.h"

namespace luxel {

/// Keeps the sides of blocks up to a limit. A trace of a chunk yields a side of every block that the chunk is part of; when they do not
/// all fit, those stay that are needed first by a reader who is at a block, goes on in the order of (a, b) and begins again at the end.
/// So a pass over all blocks traces the scene about as often as half its rows are larger than the limit, whatever the number of
/// chunks. The last few chunks stay whole, for readers who go along a row. What is kept changes only what is traced again, never a
/// result.
/// Threads: reentrant, also from inside parallel loops; whoever has to wait for a trace takes part in it.
/// Memory: limit_bytes, one chunk beyond it, run_rows rows per thread while they are traced, 16 bytes per patch, 4 per block and
/// chunk.
class TracedRows {
  public:
    /// Keeps references to `estimator` and `layout`, which must outlive it. `levels`: all that each patch has sent.
    TracedRows(const Estimator& estimator, const ChunkLayout& layout, LevelPlan levels, std::uint64_t limit_bytes);

    [[nodiscard]] const ChunkLayout& layout() const { return layout_; }
    [[nodiscard]] std::uint64_t limit_bytes() const { return limit_bytes_; }
    struct Place {
        ChunkNumber a = 0, b = 0;  ///< a <= b
        bool operator==(const Place&) const = default;
    };
    /// Block (a, b) as pooling makes it; `column` is empty if it does not exist. Throws Error{damaged_store} when a patch or pair has
    /// 2^32 rays or more.
    StripPairs block(Place at);
    /// Of the patches of chunk c, for a reader who is at a block. Throws as block().
    RayTallies tallies(ChunkNumber c, Place at);
    /// Blocks that nobody will ask for again, ascending: their sides are not kept.
    void leave_out(std::span<const Place> blocks);

    /// Rays of all chunks: what one whole trace takes. And of one chunk.
    [[nodiscard]] std::uint64_t rays_of_all() const;
    [[nodiscard]] std::uint64_t rays_of(ChunkNumber c) const;
    /// Traced so far, as often as they were.
    [[nodiscard]] std::uint64_t rays_traced() const { return rays_traced_; }
    /// Of sides and whole chunks; those that both hold are counted twice.
    [[nodiscard]] std::uint64_t held_bytes() const;
    /// Gives everything kept back.
    void forget();

  private:
    struct Job;
    using Lock = std::unique_lock<std::mutex>;
    /// Number of a side in the order of blocks: of the chunk a, then of the chunk b.
    [[nodiscard]] std::uint64_t number(ChunkNumber from, ChunkNumber to) const;
    std::shared_ptr<const Side> side(ChunkNumber from, ChunkNumber to, Place at);
    std::shared_ptr<const TracedChunk> whole(ChunkNumber c);
    std::shared_ptr<const TracedChunk> trace(ChunkNumber c, Place at, Lock& lock);
    void wait_for_trace(Lock& lock);
    void keep_whole(ChunkNumber c, std::shared_ptr<const TracedChunk> rows);
    void keep_sides(ChunkNumber c, const TracedChunk& rows, Place at);
    bool make_room(std::uint64_t bytes, std::uint64_t position, std::uint64_t distance);

    const Estimator& estimator_;
    const ChunkLayout& layout_;
    LevelPlan levels_;
    std::uint64_t limit_bytes_;
    std::atomic<std::uint64_t> rays_traced_{0};
    mutable std::mutex mutex_;
    std::condition_variable finished_;
    std::shared_ptr<Job> job_;  ///< the one trace that is running
    std::map<std::uint64_t, std::shared_ptr<const Side>> sides_;  ///< by number()
    std::uint64_t side_bytes_ = 0, whole_bytes_ = 0;
    std::list<std::pair<ChunkNumber, std::shared_ptr<const TracedChunk>>> whole_;  ///< most recently used first
    /// What is remembered of a chunk that was traced once.
    struct Known {
        RayTallies tallies;
        std::vector<ChunkNumber> targets;  ///< the chunks that it meets at all
    };
    std::vector<std::optional<Known>> known_;  ///< per chunk
    std::vector<Place> left_out_;
};

}  // namespace luxel
