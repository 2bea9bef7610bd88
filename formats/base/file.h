/// Files: read whole, read at an offset, write whole and publish by rename.
#pragma once
#include <cstdint>
#include <filesystem>
#include <memory>

#include "formats/base/bytes.h"

namespace luxel {

/// All bytes of a file that came from outside; throws Error{bad_input} (missing, a folder, unreadable).
Bytes read_file(const std::filesystem::path& path);

/// Random reads of one open file. Threads: read() is const and reentrant (pread).
class RandomFile {
  public:
    /// Throws Error{damaged_store} when it cannot be opened.
    explicit RandomFile(const std::filesystem::path& path);
    ~RandomFile();
    RandomFile(const RandomFile&) = delete;
    RandomFile& operator=(const RandomFile&) = delete;
    [[nodiscard]] std::uint64_t size() const { return size_; }
    [[nodiscard]] const std::filesystem::path& path() const { return path_; }
    /// Exactly `count` bytes at `offset`; throws Error{damaged_store} with file and offset otherwise.
    void read(std::uint64_t offset, std::span<std::uint8_t> out) const;

  private:
    std::filesystem::path path_;
    int descriptor_ = -1;
    std::uint64_t size_ = 0;
};

/// A file that appears under its name only when it is complete: written to a temporary beside it, synced, renamed.
/// Destroyed without publish(): the temporary is removed and the old file, if any, stays.
/// All failures throw Error{cannot_write} naming file and offset.
class PublishedFile {
  public:
    explicit PublishedFile(std::filesystem::path path);
    ~PublishedFile();
    PublishedFile(PublishedFile&& from) noexcept;
    PublishedFile& operator=(PublishedFile&&) = delete;
    void append(ByteView bytes);
    [[nodiscard]] std::uint64_t size() const { return size_; }
    void publish();

  private:
    std::filesystem::path path_, temporary_;
    int descriptor_ = -1;
    std::uint64_t size_ = 0;
};

/// Is this the name of a file that PublishedFile has not published yet? It is not part of anything.
bool is_temporary(const std::filesystem::path& path);

/// Removes such files of `folder` whose process no longer runs, say because it was killed; what cannot be removed stays.
void remove_leftovers(const std::filesystem::path& folder);

/// append + publish in one call.
void publish_file(const std::filesystem::path& path, ByteView bytes);

/// Makes the folder and its parents; throws Error{cannot_write}.
void make_folder(const std::filesystem::path& path);

}  // namespace luxel
