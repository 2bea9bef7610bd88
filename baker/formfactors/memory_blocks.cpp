#include "baker/formfactors/memory_blocks.h"

#include <algorithm>
#include <tuple>
#include <utility>

#include "formats/base/error.h"

namespace luxel {

namespace {

constexpr std::uint64_t page_bytes = 4096;
constexpr std::uint64_t pair_bytes = 8;

void check(const ChunkLayout& layout, std::size_t areas, std::size_t diagonal, const std::vector<ExchangePair>& pairs) {
    const std::uint32_t count = layout.patch_count();
    if (areas != count || diagonal != count)
        throw Error(ErrorCode::internal, "blocks in memory", "areas or diagonal do not have one entry per patch");
    for (ChunkNumber chunk = 0; chunk < layout.chunk_count(); ++chunk)
        if (layout.size(chunk) > ChunkLayout::max_chunk_patches)
            throw Error(ErrorCode::internal, "blocks in memory", "a chunk is larger than a block can address");
    for (const ExchangePair& pair : pairs)
        if (pair.i >= count || pair.j >= count || pair.i == pair.j || !(pair.area_m2 > 0))
            throw Error(ErrorCode::internal, "blocks in memory", "a pair is out of range, diagonal or not positive");
}

}  // namespace

MemoryBlocks::MemoryBlocks(ChunkLayout layout, std::vector<double> area_m2, std::vector<double> diagonal_m2,
                           std::vector<ExchangePair> pairs)
    : layout_(std::move(layout)), area_m2_(std::move(area_m2)), diagonal_m2_(std::move(diagonal_m2)) {
    check(layout_, area_m2_.size(), diagonal_m2_.size(), pairs);
    for (ExchangePair& pair : pairs)
        if (pair.i > pair.j) std::swap(pair.i, pair.j);
    // i < j, so the chunk of i is never above that of j.
    std::sort(pairs.begin(), pairs.end(), [&](const ExchangePair& p, const ExchangePair& q) {
        return std::tuple(layout_.chunk_of(p.i), layout_.chunk_of(p.j), p.i, p.j) <
               std::tuple(layout_.chunk_of(q.i), layout_.chunk_of(q.j), q.i, q.j);
    });
    for (std::size_t k = 0; k < pairs.size(); ++k) {
        const ExchangePair& pair = pairs[k];
        if (k > 0 && pair.i == pairs[k - 1].i && pair.j == pairs[k - 1].j)
            throw Error(ErrorCode::internal, "blocks in memory", "a pair is given twice");
        const ChunkNumber a = layout_.chunk_of(pair.i), b = layout_.chunk_of(pair.j);
        if (blocks_.empty() || blocks_.back().a != a || blocks_.back().b != b) {
            Block block;
            block.a = a;
            block.b = b;
            block.row_begin.assign(layout_.size(a) + 1, 0);
            blocks_.push_back(std::move(block));
        }
        Block& block = blocks_.back();
        ++block.row_begin[pair.i - layout_.first_patch[a] + 1];
        block.columns.push_back(static_cast<std::uint16_t>(pair.j - layout_.first_patch[b]));
        block.areas_m2.push_back(pair.area_m2);
    }
    for (Block& block : blocks_) {
        for (std::size_t row = 1; row < block.row_begin.size(); ++row) block.row_begin[row] += block.row_begin[row - 1];
        const std::uint64_t pages = (block.columns.size() * pair_bytes + page_bytes - 1) / page_bytes;
        infos_.push_back({block.a, block.b, block.columns.size(), pages * page_bytes});
    }
}

void MemoryBlocks::load(std::size_t index, Block& out) {
    out = blocks_.at(index);
    bytes_read_ += infos_[index].read_bytes;
}

std::shared_ptr<const Block> MemoryBlocks::share(std::size_t index) {
    bytes_read_ += infos_[index].read_bytes;
    return {std::shared_ptr<void>(), &blocks_[index]};  // it lives as long as this does
}

}  // namespace luxel
