#include "baker/core/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <thread>
#include <vector>

namespace luxel {
namespace {

TEST(Parallel, EveryIndexRunsOnceAndRangesAreFixed) {
    for (const unsigned threads : {1u, 2u}) {
        const ThreadLimit limit(threads);
        std::vector<std::atomic<int>> seen(1003);
        parallel_for(seen.size(), 7, [&](std::size_t i) { ++seen[i]; });
        for (const auto& count : seen) EXPECT_EQ(count, 1);
        std::vector<std::size_t> begins(11), ends(11);
        parallel_ranges(1003, 100, [&](std::size_t r, std::size_t b, std::size_t e) { begins[r] = b, ends[r] = e; });
        for (std::size_t r = 0; r < 11; ++r) {
            EXPECT_EQ(begins[r], r * 100);
            EXPECT_EQ(ends[r], std::min<std::size_t>(1003, r * 100 + 100));
        }
    }
}

TEST(Parallel, ExceptionsReachTheCaller) {
    EXPECT_THROW(parallel_for(100, 1, [](std::size_t i) { if (i == 50) throw std::runtime_error("x"); }), std::runtime_error);
}

/// The body of a loop that has failed elsewhere still gets its own loops whole: others may wait for what they make.
TEST(Parallel, ALoopInsideAFailedLoopRunsWhole) {
    if (std::thread::hardware_concurrency() < 2) GTEST_SKIP() << "needs two threads at once";
    const ThreadLimit limit(2);
    std::atomic<bool> inside{false};
    std::atomic<int> runs{0};
    EXPECT_THROW(parallel_for(2, 1,
                              [&](std::size_t i) {
                                  if (i == 0) {
                                      for (int k = 0; k < 1000 && !inside; ++k) std::this_thread::sleep_for(std::chrono::milliseconds(1));
                                      throw std::runtime_error("x");
                                  }
                                  inside = true;
                                  std::this_thread::sleep_for(std::chrono::milliseconds(100));  // until the other has failed
                                  parallel_for(64, 1, [&](std::size_t) { ++runs; });
                              }),
                 std::runtime_error);
    EXPECT_EQ(runs, 64);
}

}  // namespace
}  // namespace luxel
