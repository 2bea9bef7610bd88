/// Progress of a stage, seen from the outside. Rooms report numbers; who prints them is not their concern.
#pragma once
#include <cstdint>
#include <functional>

namespace luxel {

/// (done, total) in the stage's own unit; called now and then from any thread, never concurrently by one stage.
using ProgressFunction = std::function<void(std::uint64_t done, std::uint64_t total)>;

/// Counts from many threads, reports from one at a time.
class ProgressCounter {
  public:
    ProgressCounter(std::uint64_t total, ProgressFunction report) : total_(total), report_(std::move(report)) {}
    void add(std::uint64_t amount);

  private:
    std::uint64_t total_;
    ProgressFunction report_;
    std::uint64_t done_ = 0;
};

}  // namespace luxel
