/// A wish to stop comes from a call or from the clock, and stays.
#include "baker/core/stop.h"

#include <gtest/gtest.h>

#include <csignal>

namespace luxel {
namespace {

using std::chrono::hours;

TEST(StopRequest, IsNotThereUntilSomebodyAsks) {
    StopRequest stop;
    EXPECT_FALSE(stop.is_asked());
    stop.ask_at(StopRequest::Clock::now() + hours(1));
    EXPECT_FALSE(stop.is_asked());
    stop.ask();
    EXPECT_TRUE(stop.is_asked());
    EXPECT_TRUE(stop.was_asked());
}

TEST(StopRequest, ComesFromTheClock) {
    StopRequest stop;
    stop.ask_at(StopRequest::Clock::now());
    EXPECT_TRUE(stop.is_asked());
    EXPECT_FALSE(stop.was_asked()) << "by the clock";
}

StopRequest from_signal;

TEST(StopRequest, ComesFromASignal) {
    const auto before = std::signal(SIGUSR1, [](int) { from_signal.ask(); });
    std::raise(SIGUSR1);
    std::signal(SIGUSR1, before);
    EXPECT_TRUE(from_signal.was_asked());
}

}  // namespace
}  // namespace luxel
