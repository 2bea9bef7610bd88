/// Parallel loops. Order never matters for the result: each index owns its output, and every reduction is done over a
/// fixed partition in index order.
#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>

namespace luxel {

/// Limits the whole process to `threads` (0: all cores) and sets the floating-point environment (round to nearest,
/// denormals flushed) of every thread that enters a loop. One at a time; restores on destruction.
class ThreadLimit {
  public:
    explicit ThreadLimit(unsigned threads);
    ~ThreadLimit();
    ThreadLimit(const ThreadLimit&) = delete;
    ThreadLimit& operator=(const ThreadLimit&) = delete;
    [[nodiscard]] unsigned threads() const { return threads_; }

  private:
    unsigned threads_;
    void* state_;
};

/// Calls body(i) for i in [0, count), possibly in parallel, `grain` consecutive indexes per task. Exceptions propagate;
/// a loop that returns has run every body, also where a loop around it has failed meanwhile.
/// Denormals are flushed to zero inside the body, whichever thread runs it.
void parallel_for(std::size_t count, std::size_t grain, const std::function<void(std::size_t)>& body);

/// Calls body(begin, end) on consecutive ranges of exactly `range_size` (the last may be shorter): the partition does
/// not depend on the number of threads, so partial sums per range may be added in range order.
void parallel_ranges(std::size_t count, std::size_t range_size,
                     const std::function<void(std::size_t range, std::size_t begin, std::size_t end)>& body);

/// parallel_for whose calling thread takes up no other work while it waits for its loop: for loops inside something that
/// other tasks may wait for. Grain 1.
void parallel_isolated(std::size_t count, const std::function<void(std::size_t)>& body);

/// Sets flush-to-zero and denormals-are-zero on the calling thread (Embree asks for it; sums must agree on all threads).
void flush_denormals();

}  // namespace luxel
