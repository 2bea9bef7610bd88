#include "baker/bake/stage_clock.h"

#include <malloc.h>

#include <algorithm>

#include "baker/core/memory.h"
#include "baker/core/processor_time.h"

namespace luxel {

void StageClock::begin(const std::string& name) {
    name_ = name;
    kept_.clear();
    // What the last stage freed goes back to the system, so that peaks belong to the stage that has them.
    ::malloc_trim(0);
    reset_peak_resident_bytes();
    started_ = std::chrono::steady_clock::now();
    processor_started_ = processor_seconds_now();
    if (options_.progress) options_.progress(name_, 0, 0, "");
}

void StageClock::end(bool reused) {
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - started_;
    const double processor_seconds = processor_seconds_now() - processor_started_;
    const std::uint64_t peak = peak_resident_bytes();
    report_.stages.push_back({name_, seconds.count(), processor_seconds, peak, reused, std::move(kept_)});
    report_.peak_bytes = std::max(report_.peak_bytes, peak);
}

ProgressFunction StageClock::progress(const char* unit) const {
    if (!options_.progress) return {};
    return [this, unit](std::uint64_t done, std::uint64_t total) { options_.progress(name_, done, total, unit); };
}

double StageClock::last_seconds() const { return report_.stages.empty() ? 0 : report_.stages.back().seconds; }

}  // namespace luxel
