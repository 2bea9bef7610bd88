#include "baker/store/traced_strips.h"

#include <algorithm>
#include <iterator>

#include "baker/core/parallel.h"
#include "baker/store/pooling.h"

namespace luxel {
namespace {

constexpr std::size_t not_kept = ~std::size_t{0};

}  // namespace

StripDirectory find_directory(TracedRows& rows, const ProgressFunction& progress) {
    const ChunkNumber chunks = rows.layout().chunk_count();
    StripDirectory directory;
    for (ChunkNumber a = 0; a < chunks; ++a) {
        std::vector<DirectoryBlock> strip(chunks - a);
        parallel_for(strip.size(), 1, [&](std::size_t k) {
            const auto b = static_cast<ChunkNumber>(a + k);
            const StripPairs pairs = rows.block({a, b});
            if (!pairs.column.empty()) strip[k] = {a, b, pairs.column.size(), pack_pairs(pairs).stored.size()};
        });
        std::copy_if(strip.begin(), strip.end(), std::back_inserter(directory.blocks),
                     [](const DirectoryBlock& block) { return block.pair_count > 0; });
        directory.tallies.append(rows.tallies(a, {a, a}));
        if (progress) progress(a + 1, chunks);
    }
    return directory;
}

std::vector<bool> blocks_to_keep(const StripDirectory& directory, const TracedRows& rows, std::uint64_t budget_bytes) {
    struct Choice {
        std::size_t index;
        double rays_per_byte;
    };
    std::vector<std::uint64_t> rays;
    for (ChunkNumber c = 0; c < rows.layout().chunk_count(); ++c) rays.push_back(rows.rays_of(c));
    std::vector<Choice> choices;
    for (std::size_t k = 0; k < directory.blocks.size(); ++k) {
        const DirectoryBlock& block = directory.blocks[k];
        const std::uint64_t needed = block.a == block.b ? rays[block.a] : rays[block.a] + rays[block.b];
        choices.push_back({k, static_cast<double>(needed) / static_cast<double>(block.stored_bytes)});
    }
    std::stable_sort(choices.begin(), choices.end(),
                     [](const Choice& x, const Choice& y) { return x.rays_per_byte > y.rays_per_byte; });
    std::vector<bool> keep(directory.blocks.size());
    for (const Choice& choice : choices) {
        const std::uint64_t bytes = directory.blocks[choice.index].stored_bytes;
        if (bytes > budget_bytes) continue;
        budget_bytes -= bytes;
        keep[choice.index] = true;
    }
    return keep;
}

void keep_blocks(TracedRows& rows, const StripDirectory& directory, const std::vector<bool>& keep,
                 const std::filesystem::path& folder, const Key& hot, const ProgressFunction& progress) {
    const ChunkLayout& layout = rows.layout();
    std::vector<std::vector<DirectoryBlock>> strips(layout.chunk_count());
    for (std::size_t k = 0; k < keep.size(); ++k)
        if (keep[k]) strips[directory.blocks[k].a].push_back(directory.blocks[k]);
    for (ChunkNumber a = 0; a < layout.chunk_count(); ++a) {
        const auto path = strip_path(folder, a);
        if (!block_file_is_whole(path, FileKind::strip, strip_version, hot)) {
            std::vector<BlockFileWriter::Packed> packed(strips[a].size());
            parallel_for(packed.size(), 1, [&](std::size_t k) {
                packed[k] = pack_pairs(rows.block({a, strips[a][k].b}));
            });
            StripWriter strip(path, hot, directory.tallies.part(layout.first_patch[a], layout.first_patch[a + 1]));
            for (std::size_t k = 0; k < packed.size(); ++k) strip.append(strips[a][k].b, strips[a][k].pair_count, packed[k]);
            strip.publish();
        }
        if (progress) progress(a + 1, layout.chunk_count());
    }
}

TracedStrips::TracedStrips(TracedRows& rows, StripDirectory directory, std::unique_ptr<StripStore> kept, std::uint64_t file_bytes)
    : rows_(rows), tallies_(std::move(directory.tallies)), kept_(std::move(kept)), file_bytes_(file_bytes) {
    const auto refuse = [](const std::string& what) {
        return Error(ErrorCode::damaged_store, "directory of the matrix", what, "remove the bake folder and run the same bake again");
    };
    if (tallies_.rays.size() != layout().patch_count())
        throw refuse("tallies of " + std::to_string(tallies_.rays.size()) + " patches, expected " + std::to_string(layout().patch_count()));
    std::size_t next = 0;
    const std::span<const BlockInfo> kept_blocks = kept_ ? kept_->blocks() : std::span<const BlockInfo>();
    for (const DirectoryBlock& block : directory.blocks) {
        if (block.b >= layout().chunk_count()) throw refuse("it names a chunk that does not exist");
        blocks_.push_back({block.a, block.b, block.pair_count, strip_read_bytes(block.stored_bytes)});
        const bool found = next < kept_blocks.size() && kept_blocks[next].a == block.a && kept_blocks[next].b == block.b;
        if (found && kept_blocks[next].pair_count != block.pair_count) throw refuse("a kept block has another number of pairs");
        kept_index_.push_back(found ? next++ : not_kept);
    }
    if (next != kept_blocks.size()) throw refuse("a block is kept that it does not name");
    std::vector<TracedRows::Place> kept_places;
    for (const BlockInfo& block : kept_blocks) kept_places.push_back({block.a, block.b});
    rows_.leave_out(kept_places);
}

void TracedStrips::load(std::size_t index, CountBlock& out) const {
    const BlockInfo& info = blocks_.at(index);
    if (kept_index_[index] != not_kept) return kept_->load(kept_index_[index], out);
    StripPairs pairs = rows_.block({info.a, info.b});
    if (pairs.column.size() != info.pair_count)
        throw Error(ErrorCode::damaged_store, "block (" + std::to_string(info.a) + ", " + std::to_string(info.b) + ") traced again",
                    std::to_string(pairs.column.size()) + " pairs, the directory says " + std::to_string(info.pair_count),
                    "the bake folder was made by another program or machine: use a fresh one");
    set_pairs(info, std::move(pairs), out);
}

}  // namespace luxel
