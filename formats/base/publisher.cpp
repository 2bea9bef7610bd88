#include "formats/base/publisher.h"

namespace luxel {

Publisher::Publisher() : thread_([this] { run(); }) {}

Publisher::~Publisher() {
    {
        const std::lock_guard lock(mutex_);
        ending_ = true;
    }
    changed_.notify_all();
    thread_.join();
}

void Publisher::add(PublishedFile file) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return error_ || waiting_.size() < most_waiting; });
    if (error_) std::rethrow_exception(error_);
    waiting_.push_back(std::move(file));
    changed_.notify_all();
}

void Publisher::finish() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return waiting_.empty(); });
    if (error_) std::rethrow_exception(error_);
}

void Publisher::run() {
    std::unique_lock lock(mutex_);
    for (;;) {
        changed_.wait(lock, [&] { return ending_ || !waiting_.empty(); });
        if (waiting_.empty()) return;
        PublishedFile& file = waiting_.front();  // others may be added behind it meanwhile
        lock.unlock();
        std::exception_ptr failed;
        try {
            file.publish();
        } catch (...) {
            failed = std::current_exception();
        }
        lock.lock();
        if (failed) {
            error_ = failed;
            waiting_.clear();
        } else {
            waiting_.pop_front();
        }
        changed_.notify_all();
    }
}

}  // namespace luxel
