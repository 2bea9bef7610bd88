/// Decoded blocks kept in memory up to a limit, least recently used out first, and read ahead. What is cached changes
/// only how much is read, never a result.
#pragma once
#include <condition_variable>
#include <deque>
#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <unordered_map>

#include "baker/formfactors/block_source.h"

namespace luxel {

class BlockCache final : public BlockSource {
  public:
    /// Keeps a reference to `source`, which must outlive it. `reads_ahead`: blocks that are expected are loaded by a
    /// thread of its own, as far as half of the limit holds them; `source` must allow load() from such a thread.
    BlockCache(BlockSource& source, std::uint64_t limit_bytes, bool reads_ahead = false)
        : source_(source), limit_bytes_(limit_bytes), reads_ahead_(reads_ahead) {}
    ~BlockCache() override;
    BlockCache(const BlockCache&) = delete;
    BlockCache& operator=(const BlockCache&) = delete;
    [[nodiscard]] const ChunkLayout& layout() const override { return source_.layout(); }
    [[nodiscard]] std::span<const double> area_m2() const override { return source_.area_m2(); }
    [[nodiscard]] std::span<const double> diagonal_m2() const override { return source_.diagonal_m2(); }
    [[nodiscard]] std::span<const BlockInfo> blocks() const override { return source_.blocks(); }
    void load(std::size_t index, Block& out) override { out = *share(index); }
    [[nodiscard]] std::shared_ptr<const Block> share(std::size_t index) override;
    void expect(std::span<const std::size_t> indexes) override;
    [[nodiscard]] std::uint64_t bytes_read() const override { return source_.bytes_read(); }
    [[nodiscard]] std::uint64_t held_bytes() const { return held_bytes_; }
    [[nodiscard]] std::uint64_t hits() const { return hits_; }

    /// Resident bytes of a decoded block; and of one that is not yet decoded, from what is known of it.
    static std::uint64_t resident_bytes(const Block& block);
    static std::uint64_t resident_bytes(const BlockInfo& block, const ChunkLayout& layout);

  private:
    struct Entry {
        std::size_t index;
        std::shared_ptr<const Block> block;
    };
    void keep(std::size_t index, std::shared_ptr<const Block> block);
    void read_ahead();

    BlockSource& source_;
    std::uint64_t limit_bytes_, held_bytes_ = 0, hits_ = 0;
    const bool reads_ahead_;
    std::mutex mutex_;
    std::list<Entry> entries_;  ///< most recently used first
    std::unordered_map<std::size_t, std::list<Entry>::iterator> places_;
    // Of the reading thread, under the same mutex.
    std::deque<std::size_t> expected_;
    std::optional<std::size_t> in_work_;
    bool ends_ = false;
    std::condition_variable changed_;
    std::thread reader_;  ///< only once something is expected
};

}  // namespace luxel
