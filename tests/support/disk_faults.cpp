#include "tests/support/disk_faults.h"

#include <limits.h>
#include <sys/types.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstddef>

namespace luxel::test {
namespace {

std::atomic<DiskFault*> active{nullptr};

std::string path_of(int descriptor) {
    char path[PATH_MAX];
    const ssize_t size = ::readlink(("/proc/self/fd/" + std::to_string(descriptor)).c_str(), path, sizeof path);
    return size > 0 ? std::string(path, static_cast<std::size_t>(size)) : std::string();
}

/// Error, or the number of bytes that the call may move.
struct Answer {
    int error = 0;
    std::size_t most = std::size_t{1} << 30;
};

Answer answer(DiskCall call, int descriptor) {
    DiskFault* const fault = active;
    if (!fault) return {};
    const std::optional<int> met = fault->meets(call, path_of(descriptor));
    if (!met) return {};
    return *met ? Answer{*met, 0} : Answer{0, 7};
}

}  // namespace

DiskFault::DiskFault(DiskCall call, std::string name, std::uint64_t first, int error)
    : call_(call), name_(std::move(name)), first_(first), error_(error) {
    active = this;
}
DiskFault::~DiskFault() { active = nullptr; }

std::uint64_t DiskFault::calls() const {
    const std::lock_guard lock(mutex_);
    return calls_;
}
std::string DiskFault::struck() const {
    const std::lock_guard lock(mutex_);
    return struck_;
}

std::optional<int> DiskFault::meets(DiskCall call, const std::string& path) {
    if (call != call_ || path.find(name_) == std::string::npos) return std::nullopt;
    const std::lock_guard lock(mutex_);
    if (calls_++ < first_) return std::nullopt;
    if (struck_.empty()) struck_ = path;
    return error_;
}

}  // namespace luxel::test

// The linker's --wrap sends calls of the program's own libraries here.
extern "C" {

ssize_t __real_pread(int descriptor, void* to, std::size_t size, off_t at);
ssize_t __real_write(int descriptor, const void* from, std::size_t size);
int __real_fsync(int descriptor);
int __real_rename(const char* from, const char* to);

ssize_t __wrap_pread(int descriptor, void* to, std::size_t size, off_t at) {
    const auto answer = luxel::test::answer(luxel::test::DiskCall::read, descriptor);
    if (answer.error) return errno = answer.error, -1;
    return __real_pread(descriptor, to, std::min(size, answer.most), at);
}

ssize_t __wrap_write(int descriptor, const void* from, std::size_t size) {
    const auto answer = luxel::test::answer(luxel::test::DiskCall::write, descriptor);
    if (answer.error) return errno = answer.error, -1;
    return __real_write(descriptor, from, std::min(size, answer.most));
}

int __wrap_fsync(int descriptor) {
    const auto answer = luxel::test::answer(luxel::test::DiskCall::sync, descriptor);
    if (answer.error) return errno = answer.error, -1;
    return __real_fsync(descriptor);
}

int __wrap_rename(const char* from, const char* to) {
    luxel::test::DiskFault* const fault = luxel::test::active;
    const std::optional<int> met = fault ? fault->meets(luxel::test::DiskCall::rename, to) : std::nullopt;
    if (met && *met) return errno = *met, -1;
    return __real_rename(from, to);
}

}  // extern "C"
