#include "baker/core/progress.h"

#include <mutex>

namespace luxel {

void ProgressCounter::add(std::uint64_t amount) {
    static std::mutex mutex;  // reports are rare; one lock for all counters keeps the class copyable by its owner
    const std::lock_guard lock(mutex);
    done_ += amount;
    if (report_) report_(done_, total_);
}

}  // namespace luxel
