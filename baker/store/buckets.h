/// Pairs on their way from evidence to strips, one bucket per strip. Held in memory up to a limit, then spilled to one
/// anonymous scratch file that disappears with the process.
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <vector>

#include "baker/formfactors/block_source.h"

namespace luxel {

/// One observation: b (16 bits), row in a (16), column in b (16), count (16), from high to low: sorting the numbers
/// sorts by block, row, column.
using PackedPair = std::uint64_t;
constexpr PackedPair pack_pair(std::uint32_t b, std::uint32_t row, std::uint32_t column, std::uint32_t count) {
    return (std::uint64_t{b} << 48) | (std::uint64_t{row} << 32) | (std::uint64_t{column} << 16) | count;
}
constexpr std::uint32_t pair_chunk(PackedPair pair) { return static_cast<std::uint32_t>(pair >> 48); }
constexpr std::uint32_t pair_count(PackedPair pair) { return static_cast<std::uint32_t>(pair & 0xffff); }
constexpr std::uint64_t pair_place(PackedPair pair) { return pair >> 16; }
constexpr std::uint32_t max_pair_count = 0xffff;
/// Appends one observation; counts above 65535 become several.
inline void append_pairs(std::vector<PackedPair>& pairs, std::uint32_t b, std::uint32_t row, std::uint32_t column,
                         std::uint32_t count) {
    for (; count > max_pair_count; count -= max_pair_count) pairs.push_back(pack_pair(b, row, column, max_pair_count));
    pairs.push_back(pack_pair(b, row, column, count));
}
/// Chunks are numbered in 16 bits inside a bucket.
constexpr std::uint32_t max_chunks = 65536;

class PairBuckets {
  public:
    PairBuckets(std::uint32_t bucket_count, std::uint64_t memory_bytes, const std::filesystem::path& scratch_folder);
    ~PairBuckets();
    PairBuckets(const PairBuckets&) = delete;
    PairBuckets& operator=(const PairBuckets&) = delete;
    void add(std::uint32_t bucket, std::span<const PackedPair> pairs);
    /// Moves to the scratch file what exceeds the limit. Call between batches. Throws Error{cannot_write}.
    void settle();
    [[nodiscard]] std::uint64_t size(std::uint32_t bucket) const;
    /// Visits all pairs of a bucket in runs of bounded size, order unspecified. Throws Error{damaged_store}.
    void visit(std::uint32_t bucket, const std::function<void(std::span<const PackedPair>)>& body) const;
    /// Frees a bucket's memory.
    void release(std::uint32_t bucket);

  private:
    struct Extent {
        std::uint64_t offset, count;
    };
    std::uint64_t limit_pairs_, held_pairs_ = 0;
    std::vector<std::vector<PackedPair>> held_;
    std::vector<std::vector<Extent>> spilled_;
    std::filesystem::path scratch_folder_;
    int scratch_ = -1;
    std::uint64_t scratch_bytes_ = 0;
};

}  // namespace luxel
