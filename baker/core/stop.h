/// A wish that long work ends early with what it has, from a signal handler, a clock, or another thread. Once made it stays.
///
/// Whoever works asks is_asked() between two pieces of its work: one relaxed load, and a look at the clock where there is a
/// deadline. What to do about it is each stage's own affair (bake/stopping.h).
#pragma once
#include <atomic>
#include <chrono>
#include <cstdint>
#include <limits>

namespace luxel {

class StopRequest {
  public:
    using Clock = std::chrono::steady_clock;

    /// Safe in a signal handler and from any thread.
    void ask() noexcept { asked_.store(true, std::memory_order_relaxed); }
    /// From then on it is asked for. Before the work begins.
    void ask_at(Clock::time_point deadline) noexcept { deadline_ = deadline.time_since_epoch().count(); }

    /// Threads: any.
    [[nodiscard]] bool is_asked() const noexcept { return was_asked() || is_late(); }
    /// By ask(), not by the clock.
    [[nodiscard]] bool was_asked() const noexcept { return asked_.load(std::memory_order_relaxed); }

  private:
    [[nodiscard]] bool is_late() const noexcept {
        return deadline_ != never && Clock::now().time_since_epoch().count() >= deadline_;
    }
    static constexpr Clock::rep never = std::numeric_limits<Clock::rep>::max();
    std::atomic<bool> asked_{false};
    Clock::rep deadline_ = never;
    static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler writes it");
};

}  // namespace luxel
