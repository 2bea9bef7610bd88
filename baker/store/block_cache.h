/// Decoded blocks kept in memory up to a limit, least recently used out first. What is cached changes only how much is
/// read, never a result.
#pragma once
#include <list>
#include <memory>
#include <mutex>
#include <unordered_map>

#include "baker/formfactors/block_source.h"

namespace luxel {

class BlockCache final : public BlockSource {
  public:
    /// Keeps a reference to `source`, which must outlive it.
    BlockCache(BlockSource& source, std::uint64_t limit_bytes) : source_(source), limit_bytes_(limit_bytes) {}
    [[nodiscard]] const ChunkLayout& layout() const override { return source_.layout(); }
    [[nodiscard]] std::span<const double> area_m2() const override { return source_.area_m2(); }
    [[nodiscard]] std::span<const double> diagonal_m2() const override { return source_.diagonal_m2(); }
    [[nodiscard]] std::span<const BlockInfo> blocks() const override { return source_.blocks(); }
    void load(std::size_t index, Block& out) override;
    [[nodiscard]] std::uint64_t bytes_read() const override { return source_.bytes_read(); }
    [[nodiscard]] std::uint64_t held_bytes() const { return held_bytes_; }
    [[nodiscard]] std::uint64_t hits() const { return hits_; }

    /// Resident bytes of a decoded block.
    static std::uint64_t resident_bytes(const Block& block);

  private:
    struct Entry {
        std::size_t index;
        std::shared_ptr<const Block> block;
    };
    BlockSource& source_;
    std::uint64_t limit_bytes_, held_bytes_ = 0, hits_ = 0;
    std::mutex mutex_;
    std::list<Entry> entries_;  ///< most recently used first
    std::unordered_map<std::size_t, std::list<Entry>::iterator> places_;
};

}  // namespace luxel
