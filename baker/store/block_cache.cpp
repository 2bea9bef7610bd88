#include "baker/store/block_cache.h"

#include <algorithm>

#include "baker/core/parallel.h"

namespace luxel {

std::uint64_t BlockCache::resident_bytes(const Block& block) {
    return block.row_begin.size() * sizeof(block.row_begin[0]) + block.columns.size() * sizeof(block.columns[0]) +
           block.areas_m2.size() * sizeof(block.areas_m2[0]);
}

std::uint64_t BlockCache::resident_bytes(const BlockInfo& block, const ChunkLayout& layout) {
    return (layout.size(block.a) + std::uint64_t{1}) * sizeof(std::uint32_t) +
           block.pair_count * (sizeof(std::uint16_t) + sizeof(float));
}

BlockCache::~BlockCache() {
    {
        const std::lock_guard lock(mutex_);
        ends_ = true;
    }
    changed_.notify_all();
    if (reader_.joinable()) reader_.join();
}

std::shared_ptr<const Block> BlockCache::share(std::size_t index) {
    {
        std::unique_lock lock(mutex_);
        // Nobody waits for what has not been begun.
        if (const auto at = std::find(expected_.begin(), expected_.end(), index); at != expected_.end())
            expected_.erase(at);
        changed_.wait(lock, [&] { return in_work_ != index; });
        if (const auto at = places_.find(index); at != places_.end()) {
            entries_.splice(entries_.begin(), entries_, at->second);
            ++hits_;
            return entries_.front().block;
        }
    }
    auto block = std::make_shared<Block>();
    source_.load(index, *block);
    const std::lock_guard lock(mutex_);
    keep(index, block);
    return block;
}

/// Under the mutex.
void BlockCache::keep(std::size_t index, std::shared_ptr<const Block> block) {
    const std::uint64_t bytes = resident_bytes(*block);
    if (bytes > limit_bytes_ || places_.contains(index)) return;  // too large, or another thread was faster
    while (held_bytes_ + bytes > limit_bytes_) {
        held_bytes_ -= resident_bytes(*entries_.back().block);
        places_.erase(entries_.back().index);
        entries_.pop_back();
    }
    entries_.push_front({index, std::move(block)});
    places_[index] = entries_.begin();
    held_bytes_ += bytes;
}

void BlockCache::expect(std::span<const std::size_t> indexes) {
    if (!reads_ahead_) return;
    const std::lock_guard lock(mutex_);
    expected_.clear();
    std::uint64_t bytes = 0;
    for (const std::size_t index : indexes) {
        if (places_.contains(index)) continue;
        bytes += resident_bytes(source_.blocks()[index], source_.layout());
        if (bytes > limit_bytes_ / 2) break;
        expected_.push_back(index);
    }
    if (expected_.empty()) return;
    if (!reader_.joinable()) reader_ = std::thread([this] { read_ahead(); });
    changed_.notify_all();
}

void BlockCache::read_ahead() {
    flush_denormals();
    std::unique_lock lock(mutex_);
    for (;;) {
        changed_.wait(lock, [&] { return ends_ || !expected_.empty(); });
        if (ends_) return;
        const std::size_t index = expected_.front();
        expected_.pop_front();
        in_work_ = index;
        lock.unlock();
        auto block = std::make_shared<Block>();
        bool good = true;
        try {
            source_.load(index, *block);
        } catch (...) {
            good = false;  // who asks for it will meet the same fault, and tell
        }
        lock.lock();
        if (good) keep(index, std::move(block));
        in_work_.reset();
        changed_.notify_all();
    }
}

}  // namespace luxel
