// A loop whose bodies write one variable unguarded: the thread sanitizer must report it, through the annotations of
// baker/core/parallel.cpp, or it would report nothing at all. Built for the
// thread sanitizer only. Needs two cores: with one there is no second thread to race with.
#include <chrono>
#include <cstdio>
#include <thread>

#include "baker/core/parallel.h"

int main() {
    const luxel::ThreadLimit limit(2);
    int unguarded = 0;
    luxel::parallel_for(100, 1, [&](std::size_t) {
        ++unguarded;
        std::this_thread::sleep_for(std::chrono::milliseconds(1));  // time for the second thread to join in
    });
    std::printf("%d\n", unguarded);
    return 0;
}
