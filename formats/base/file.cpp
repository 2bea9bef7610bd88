#include "formats/base/file.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <string_view>
#include <utility>

namespace luxel {
namespace {

std::string system_text() { return std::strerror(errno); }

/// Of an open file; it may have changed since it was opened.
std::uint64_t size_now(int descriptor) {
    struct stat status {};
    return ::fstat(descriptor, &status) == 0 ? static_cast<std::uint64_t>(status.st_size) : 0;
}

constexpr std::string_view temporary_mark = ".tmp-";

/// Number of the process that writes, or wrote, the temporary `name`; 0 if it is none.
pid_t writer_of(const std::string& name) {
    const std::size_t mark = name.rfind(temporary_mark);
    if (mark == std::string::npos) return 0;
    const char* const end = name.data() + name.size();
    pid_t writer = 0;
    unsigned serial = 0;
    const auto [dash, failed] = std::from_chars(name.data() + mark + temporary_mark.size(), end, writer);
    if (failed != std::errc() || writer <= 0 || dash == end || *dash != '-') return 0;
    const auto [rest, serial_failed] = std::from_chars(dash + 1, end, serial);
    return serial_failed == std::errc() && rest == end ? writer : 0;
}

}  // namespace

Bytes read_file(const std::filesystem::path& path) {
    const auto refuse = [&](const std::string& what) {
        return Error(ErrorCode::bad_input, path.string(), what, "check the path and its permissions");
    };
    const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (descriptor < 0) throw refuse("cannot open: " + system_text());
    struct stat status {};
    if (::fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode)) {
        ::close(descriptor);
        throw refuse("expected a file, found a folder or device");
    }
    Bytes bytes(static_cast<std::size_t>(status.st_size));
    std::size_t done = 0;
    while (done < bytes.size()) {
        const ssize_t got = ::read(descriptor, bytes.data() + done, bytes.size() - done);
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) {
            const std::string why = got < 0 ? system_text() : "the file shrank while it was read";
            ::close(descriptor);
            throw refuse("cannot read at byte " + std::to_string(done) + ": " + why);
        }
        done += static_cast<std::size_t>(got);
    }
    ::close(descriptor);
    return bytes;
}

RandomFile::RandomFile(const std::filesystem::path& path) : path_(path) {
    descriptor_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    struct stat status {};
    if (descriptor_ < 0 || ::fstat(descriptor_, &status) != 0 || !S_ISREG(status.st_mode)) {
        const std::string why = descriptor_ < 0 ? system_text() : "not a file";
        if (descriptor_ >= 0) ::close(descriptor_);
        throw Error(ErrorCode::damaged_store, path.string(), "cannot open: " + why,
                    "run the command again that wrote it");
    }
    size_ = static_cast<std::uint64_t>(status.st_size);
}

RandomFile::~RandomFile() { ::close(descriptor_); }

void RandomFile::read(std::uint64_t offset, std::span<std::uint8_t> out) const {
    std::size_t done = 0;
    while (done < out.size()) {
        const ssize_t got =
            ::pread(descriptor_, out.data() + done, out.size() - done, static_cast<off_t>(offset + done));
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0)
            throw Error(ErrorCode::damaged_store, path_.string(),
                        "cannot read " + std::to_string(out.size()) + " bytes at byte " + std::to_string(offset) +
                            ": " +
                            (got < 0 ? system_text() : "file ends at byte " + std::to_string(size_now(descriptor_))),
                        got < 0 ? "check the disk; remove the file and run the same command again"
                                : "remove the file and run the same command again");
        done += static_cast<std::size_t>(got);
    }
}

PublishedFile::PublishedFile(std::filesystem::path path) : path_(std::move(path)) {
    static std::atomic<unsigned> serial{0};
    std::error_code ignored;
    if (std::filesystem::is_directory(path_, ignored))
        throw Error(ErrorCode::cannot_write, path_.string(), "expected a file name, found a folder",
                    "name a file inside it");
    temporary_ = path_;
    temporary_ += std::string(temporary_mark) + std::to_string(::getpid()) + "-" + std::to_string(serial++);
    descriptor_ = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (descriptor_ < 0)
        throw Error(ErrorCode::cannot_write, path_.string(), "cannot create: " + system_text(),
                    "check that the folder exists and can be written");
}

PublishedFile::PublishedFile(PublishedFile&& from) noexcept
    : path_(std::move(from.path_)),
      temporary_(std::move(from.temporary_)),
      descriptor_(std::exchange(from.descriptor_, -1)),
      size_(from.size_) {}

PublishedFile::~PublishedFile() {
    if (descriptor_ >= 0) {
        ::close(descriptor_);
        ::unlink(temporary_.c_str());
    }
}

void PublishedFile::append(ByteView bytes) {
    std::size_t done = 0;
    while (done < bytes.size()) {
        const ssize_t put = ::write(descriptor_, bytes.data() + done, bytes.size() - done);
        if (put < 0 && errno == EINTR) continue;
        if (put <= 0)
            throw Error(ErrorCode::cannot_write, path_.string(),
                        "cannot write at byte " + std::to_string(size_) + ": " + system_text(),
                        "free some space or choose another folder");
        done += static_cast<std::size_t>(put);
        size_ += static_cast<std::uint64_t>(put);
    }
}

void PublishedFile::publish() {
    const auto refuse = [&](const char* step) {
        return Error(ErrorCode::cannot_write, path_.string(), std::string(step) + ": " + system_text(),
                     "free some space or choose another folder");
    };
    if (::fsync(descriptor_) != 0) throw refuse("cannot sync");
    if (::rename(temporary_.c_str(), path_.c_str()) != 0) throw refuse("cannot rename the finished file");
    ::close(descriptor_);
    descriptor_ = -1;
    // The name itself is durable only once the folder is synced.
    const auto folder = path_.has_parent_path() ? path_.parent_path() : std::filesystem::path(".");
    const int directory = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (directory >= 0) {
        ::fsync(directory);
        ::close(directory);
    }
}

bool is_temporary(const std::filesystem::path& path) { return writer_of(path.filename().string()) != 0; }

void remove_leftovers(const std::filesystem::path& folder) {
    std::error_code ignored;
    for (const auto& entry : std::filesystem::directory_iterator(folder, ignored)) {
        const pid_t writer = writer_of(entry.path().filename().string());
        if (writer && ::kill(writer, 0) != 0 && errno == ESRCH) std::filesystem::remove(entry.path(), ignored);
    }
}

void publish_file(const std::filesystem::path& path, ByteView bytes) {
    PublishedFile file(path);
    file.append(bytes);
    file.publish();
}

void make_folder(const std::filesystem::path& path) {
    std::error_code error;
    std::filesystem::create_directories(path, error);
    if (error || !std::filesystem::is_directory(path))
        throw Error(ErrorCode::cannot_write, path.string(),
                    "cannot make this folder: " + (error ? error.message() : std::string("a file is in its place")));
}

}  // namespace luxel
