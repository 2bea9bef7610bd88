#include "baker/store/block_cache.h"

namespace luxel {

std::uint64_t BlockCache::resident_bytes(const Block& block) {
    return block.row_begin.size() * sizeof(block.row_begin[0]) + block.columns.size() * sizeof(block.columns[0]) +
           block.areas_m2.size() * sizeof(block.areas_m2[0]);
}

void BlockCache::load(std::size_t index, Block& out) {
    std::shared_ptr<const Block> found;
    {
        const std::lock_guard lock(mutex_);
        if (const auto at = places_.find(index); at != places_.end()) {
            entries_.splice(entries_.begin(), entries_, at->second);
            found = entries_.front().block;
            ++hits_;
        }
    }
    if (found) {
        out = *found;
        return;
    }
    source_.load(index, out);
    const std::uint64_t bytes = resident_bytes(out);
    if (bytes > limit_bytes_) return;
    auto copy = std::make_shared<const Block>(out);
    const std::lock_guard lock(mutex_);
    if (places_.contains(index)) return;  // another thread was faster
    while (held_bytes_ + bytes > limit_bytes_) {
        held_bytes_ -= resident_bytes(*entries_.back().block);
        places_.erase(entries_.back().index);
        entries_.pop_back();
    }
    entries_.push_front({index, std::move(copy)});
    places_[index] = entries_.begin();
    held_bytes_ += bytes;
}

}  // namespace luxel
