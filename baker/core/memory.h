/// Resident memory of this process, as the system counts it.
#pragma once
#include <cstdint>

namespace luxel {

std::uint64_t resident_bytes_now();
/// Highest resident size since the start or the last reset_peak_resident_bytes().
std::uint64_t peak_resident_bytes();
/// Starts a new peak measurement where the system allows it (Linux: /proc/self/clear_refs); else does nothing.
void reset_peak_resident_bytes();

}  // namespace luxel
