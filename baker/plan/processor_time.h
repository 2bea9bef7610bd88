/// How long work takes on all of a bake's threads if no other program runs, measured while some may.
#pragma once
#include <algorithm>
#include <ctime>
#include <thread>

namespace luxel {

class ProcessorTime {
  public:
    /// `threads`: that the work is spread over evenly; 0: one per core.
    explicit ProcessorTime(unsigned threads) : threads_(threads ? threads : std::max(1u, std::thread::hardware_concurrency())) {}

    /// Since construction: what all threads of the process have used, divided among them.
    [[nodiscard]] double seconds() const { return (used() - begin_) / threads_; }

  private:
    static double used() {
        timespec t{};
        ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
        return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
    }

    unsigned threads_;
    double begin_ = used();
};

}  // namespace luxel
