/// Who looks at a solve between its steps: progress, previews, checkpoints, and the wish to stop.
///
/// A checkpoint is copied out of the solver at a step and written by a thread of its own while the solve goes on; memory: one
/// SolveState. The last one is kept until the solution is saved. None where the bake folder is not kept. Threads: one at a time.
#pragma once
#include <chrono>
#include <future>

#include "baker/bake/preview.h"

namespace luxel {

class SolveWatch {
  public:
    /// `checkpoint`, `key`: where it goes, and the name of the solution. References must outlive it; `preview` may be null.
    SolveWatch(const BakeOptions& options, std::filesystem::path checkpoint, const Key& key, ProgressFunction progress, Preview* preview);
    /// SolveOptions::step. Throws Error{cannot_write}, also for the checkpoint before.
    bool step(const SolveView& solve);
    /// Waits for the checkpoint that is being written. Throws what it threw.
    void finish();

    [[nodiscard]] std::uint64_t steps() const { return steps_; }
    [[nodiscard]] bool has_stopped() const { return stopped_; }

  private:
    using Clock = std::chrono::steady_clock;
    void save(const SolveView& solve);

    const BakeOptions& options_;
    std::filesystem::path checkpoint_;
    Key key_;
    ProgressFunction progress_;
    Preview* preview_;
    Clock::time_point last_ = Clock::now();
    std::uint64_t steps_ = 0;
    bool stopped_ = false;
    std::future<void> writing_;  ///< last: waits for the thread before anything else goes
};

}  // namespace luxel
