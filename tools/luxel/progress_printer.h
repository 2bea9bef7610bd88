/// Progress on standard error: one line that is drawn over on a terminal, plain lines elsewhere.
#pragma once
#include <chrono>
#include <cstdint>
#include <mutex>
#include <string>

namespace luxel {

class ProgressPrinter {
  public:
    explicit ProgressPrinter(bool quiet);
    /// total 0: the end is not known. Threads: reentrant.
    void update(const std::string& stage, std::uint64_t done, std::uint64_t total, const char* unit);
    /// Ends the last stage's line.
    void finish();

  private:
    using Clock = std::chrono::steady_clock;
    void end_stage();
    [[nodiscard]] std::string line(std::uint64_t done, std::uint64_t total, const char* unit, double seconds) const;

    bool quiet_, terminal_;
    std::mutex mutex_;
    std::string stage_;
    Clock::time_point stage_start_, last_print_;
};

}  // namespace luxel
