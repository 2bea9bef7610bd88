/// Faults of the disk, at any call: a program linked with luxel_disk_faults reads, writes, syncs and renames through
/// this.
#pragma once
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>

namespace luxel::test {

enum class DiskCall { read, write, sync, rename };

/// While it lives, calls of one kind on files with `name` in their path are counted, and those from number `first` on
/// fail with `error` (EIO, ENOSPC, ...): a disk does not recover by itself. Error 0 is none: reads and writes move at
/// most 7 bytes, which is legal. One at a time. Threads: calls may come from any.
class DiskFault {
  public:
    DiskFault(DiskCall call, std::string name, std::uint64_t first, int error);
    ~DiskFault();
    DiskFault(const DiskFault&) = delete;
    DiskFault& operator=(const DiskFault&) = delete;

    [[nodiscard]] std::uint64_t calls() const;
    /// Path of the first file that was struck; empty if none was.
    [[nodiscard]] std::string struck() const;

    /// What a call on this path must do: the error, 0 for a short one, nothing for a whole one.
    std::optional<int> meets(DiskCall call, const std::string& path);

  private:
    const DiskCall call_;
    const std::string name_;
    const std::uint64_t first_;
    const int error_;
    mutable std::mutex mutex_;
    std::uint64_t calls_ = 0;
    std::string struck_;
};

}  // namespace luxel::test
