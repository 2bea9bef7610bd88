/// Processor time of this process: what other programs do meanwhile is not in it.
#pragma once
#include <ctime>

namespace luxel {

/// Of all threads since the process began, s.
inline double processor_seconds_now() {
    timespec t{};
    ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

}  // namespace luxel
