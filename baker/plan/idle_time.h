/// How long work takes on all of a bake's threads if no other program runs, measured while some may.
#pragma once
#include <algorithm>
#include <thread>

#include "baker/core/processor_time.h"

namespace luxel {

class IdleTime {
  public:
    /// `threads`: that the work is spread over evenly; 0: one per core.
    explicit IdleTime(unsigned threads) : threads_(threads ? threads : std::max(1u, std::thread::hardware_concurrency())) {}

    /// Since construction: what all threads of the process have used, divided among them.
    [[nodiscard]] double seconds() const { return (processor_seconds_now() - begin_) / threads_; }

  private:
    unsigned threads_;
    double begin_ = processor_seconds_now();
};

}  // namespace luxel
