/// Publishes files behind the work that makes the next ones: the disk takes milliseconds to promise that it has a file.
#pragma once
#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <thread>

#include "formats/base/file.h"

namespace luxel {

/// One thread that publishes complete files in the order in which they come. What the process loses when it is killed:
/// at most `most_waiting` files that were complete but not published, and what their makers had in work. Threads: add()
/// from any; finish() from one, when nobody adds any more.
class Publisher {
  public:
    static constexpr std::size_t most_waiting = 2;
    Publisher();
    /// Publishes what waits. Errors are lost here: call finish() before files are counted on.
    ~Publisher();
    Publisher(const Publisher&) = delete;
    Publisher& operator=(const Publisher&) = delete;

    /// Takes a complete file; waits while `most_waiting` others are in work. Throws the Error{cannot_write} of any file
    /// before it, and then no file is published any more.
    void add(PublishedFile file);
    /// Returns when all files are published; throws the Error{cannot_write} of the first that was not.
    void finish();

  private:
    void run();
    std::mutex mutex_;
    std::condition_variable changed_;
    std::deque<PublishedFile> waiting_;  ///< the first is in work
    std::exception_ptr error_;
    bool ending_ = false;
    std::thread thread_;
};

}  // namespace luxel
