#include "baker/core/memory.h"

#include <cstdio>
#include <cstring>

namespace luxel {
namespace {

std::uint64_t status_bytes(const char* field) {
    std::FILE* file = std::fopen("/proc/self/status", "r");
    if (!file) return 0;
    char line[256];
    unsigned long long kilobytes = 0;
    const std::size_t length = std::strlen(field);
    while (std::fgets(line, sizeof line, file))
        if (std::strncmp(line, field, length) == 0) {
            std::sscanf(line + length, "%llu", &kilobytes);
            break;
        }
    std::fclose(file);
    return kilobytes * 1024;
}

}  // namespace

std::uint64_t resident_bytes_now() { return status_bytes("VmRSS:"); }
std::uint64_t peak_resident_bytes() { return status_bytes("VmHWM:"); }

void reset_peak_resident_bytes() {
    if (std::FILE* file = std::fopen("/proc/self/clear_refs", "w")) {
        std::fputs("5", file);
        std::fclose(file);
    }
}

}  // namespace luxel
