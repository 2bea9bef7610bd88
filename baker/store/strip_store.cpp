#include "baker/store/strip_store.h"

#include <algorithm>

#include "baker/store/pooling.h"

namespace luxel {
namespace {

constexpr std::size_t max_open_files = 128;

}  // namespace

StripStore::StripStore(std::filesystem::path folder, const Key& key, const ChunkLayout& layout)
    : folder_(std::move(folder)), key_(key), layout_(layout) {
    for (ChunkNumber a = 0; a < layout_.chunk_count(); ++a) {
        const BlockFileReader file(strip_path(folder_, a), FileKind::strip, strip_version, &key_);
        const RayTallies part = read_tallies(file);
        if (part.rays.size() != layout_.size(a))
            throw Error(ErrorCode::damaged_store, file.name(),
                        "tallies of " + std::to_string(part.rays.size()) + " patches, expected " +
                            std::to_string(layout_.size(a)));
        tallies_.append(part);
        first_block_.push_back(blocks_.size());
        const auto directory = read_strip_directory(file);
        for (std::size_t k = 0; k < directory.size(); ++k) {
            if (directory[k].b < a || directory[k].b >= layout_.chunk_count())
                throw Error(ErrorCode::damaged_store, file.name(), "directory names a chunk that does not exist");
            const BlockEntry& entry = file.blocks()[first_pair_block + k];
            blocks_.push_back({a, directory[k].b, directory[k].pair_count, strip_read_bytes(entry.stored_bytes)});
        }
        file_bytes_ += file.file_bytes();
    }
}

std::shared_ptr<const BlockFileReader> StripStore::open_strip(ChunkNumber a) const {
    const std::lock_guard lock(mutex_);
    for (auto at = open_.begin(); at != open_.end(); ++at)
        if (at->first == a) {
            open_.splice(open_.begin(), open_, at);
            return open_.front().second;
        }
    open_.emplace_front(a, std::make_shared<const BlockFileReader>(strip_path(folder_, a), FileKind::strip,
                                                                   strip_version, &key_));
    if (open_.size() > max_open_files) open_.pop_back();
    return open_.front().second;
}

void StripStore::load(std::size_t index, CountBlock& out) const {
    const BlockInfo& info = blocks_.at(index);
    const auto file = open_strip(info.a);
    const std::size_t at = first_pair_block + index - first_block_[info.a];
    const std::string where = file->name() + ": block " + std::to_string(at);
    StripPairs pairs{0, 0, std::move(out.row_begin), std::move(out.columns), std::move(out.counts)};
    pairs = unpack_pairs(file->read(at), info.a == info.b, where, std::move(pairs));
    if (pairs.rows != layout_.size(info.a) || pairs.columns != layout_.size(info.b) ||
        pairs.column.size() != info.pair_count)
        throw Error(ErrorCode::damaged_store, where, "size does not fit the chunks",
                    "remove the file and run the same command again");
    set_pairs(info, std::move(pairs), out);
}

}  // namespace luxel
