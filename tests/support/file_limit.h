/// A disk that is full: no file of this process may grow beyond a limit while the object lives.
#pragma once
#include <sys/resource.h>

#include <csignal>
#include <cstdint>

namespace luxel::test {

class FileLimit {
  public:
    explicit FileLimit(std::uint64_t bytes) {
        handler_ = std::signal(SIGXFSZ, SIG_IGN);  // the write fails instead
        ::getrlimit(RLIMIT_FSIZE, &before_);
        const rlimit limit{bytes, before_.rlim_max};
        ::setrlimit(RLIMIT_FSIZE, &limit);
    }
    ~FileLimit() {
        ::setrlimit(RLIMIT_FSIZE, &before_);
        std::signal(SIGXFSZ, handler_);
    }
    FileLimit(const FileLimit&) = delete;
    FileLimit& operator=(const FileLimit&) = delete;

  private:
    rlimit before_{};
    void (*handler_)(int);
};

}  // namespace luxel::test
