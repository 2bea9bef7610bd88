/// Ctrl-C: the first one asks the work to end with what it has, the second one ends the program at once.
#pragma once
#include "baker/core/stop.h"

namespace luxel {

/// Exit code of a bake that a signal has cut short and that has written what was there: 128 + SIGINT, as shells say it.
constexpr int exit_interrupted = 130;

/// While it lives, the first SIGINT or SIGTERM asks `request` and says so on standard error; a second one does what signals do.
/// A signal that the caller had the program ignore stays ignored. One at a time; `request` must outlive it.
class InterruptGuard {
  public:
    explicit InterruptGuard(StopRequest& request);
    ~InterruptGuard();
    InterruptGuard(const InterruptGuard&) = delete;
    InterruptGuard& operator=(const InterruptGuard&) = delete;
};

}  // namespace luxel
